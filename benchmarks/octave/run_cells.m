% Runs cells of Table 1 in plain GNU Octave, interleaved, and prints one JSON object with what each took.
%
%   octave-cli -qf benchmarks/octave/run_cells.m INITIAL.npy HBAR STEP STEPS REPETITIONS FOLDER CELL ...
%
% INITIAL.npy holds W(0) as `integrate --output` or np.save writes it; HBAR is paper or standard; CELL is a
% formulation with its number of stages, such as cotangent2, group3, algebra1 (the isospectral midpoint rule). W at
% the end goes to FOLDER/CELL.npy; "-" writes none. seconds is the CPU time of a run, set-up excluded, the least of
% the repetitions; product_seconds that of one product of n x n complex matrices, measured in this process.
% Exit status: 0 done, 2 bad arguments, 3 a run did not converge.
1;

function refuse(format, varargin)
  fprintf(stderr, ["run_cells: ", format, "\n"], varargin{:});
  exit(2);
end

function seconds = seconds_of_product(W)
  % Returns the CPU seconds of one product: the least of five trials of some 0.05 s. A call takes 3e-6 s at least.
  count = max(1, round(0.05/max(3e-6, 8*rows(W)^3/4e10)));
  seconds = Inf;
  for trial = 1:5
    begun = cputime();
    for k = 1:count
      C = W*W;
    end
    seconds = min(seconds, (cputime() - begun)/count);
  end
end

arguments = argv();
if numel(arguments) < 7
  refuse("needs INITIAL.npy HBAR STEP STEPS REPETITIONS FOLDER CELL ...");
end
addpath(fileparts(mfilename("fullpath")));
try
  W0 = read_npy(arguments{1});
catch problem
  refuse("%s", problem.message);
end
n = rows(W0);
switch arguments{2}
  case "paper"
    hbar = 2/sqrt(n*(n - 1));
  case "standard"
    hbar = 2/sqrt(n^2 - 1);
  otherwise
    refuse("HBAR %s: must be paper or standard", arguments{2});
end
numbers = str2double(arguments(3:5));
if any(!isfinite(numbers)) || any(numbers <= 0) || any(numbers(2:3) != fix(numbers(2:3)))
  refuse("STEP STEPS REPETITIONS: must be a positive number and two positive whole ones");
end
cells = arguments(7:end);
for k = 1:numel(cells)
  if isempty(regexp(cells{k}, "^(cotangent|group|algebra)[123]$"))
    refuse("CELL %s: must be cotangent, group or algebra, and 1, 2 or 3", cells{k});
  end
end

texts = cell(size(cells));
status = 0;
best = Inf(size(cells));
for repetition = 1:numbers(3)
  for k = 1:numel(cells)
    [W, found] = run_cell(cells{k}, W0, numbers(1), numbers(2), hbar, 1e-13);
    best(k) = min(best(k), found.seconds);
    if !strcmp(found.status, "converged")
      status = 3;
    elseif repetition == 1 && !strcmp(arguments{6}, "-")
      try
        write_npy(fullfile(arguments{6}, [cells{k}, ".npy"]), W);
      catch problem
        refuse("%s", problem.message);
      end
    end
    texts{k} = sprintf(["{\"cell\": \"%s\", \"status\": \"%s\", \"failed_step\": %d, \"seconds\": %.6g, ", ...
                        "\"sweeps\": %d, \"products\": %d}"], cells{k}, found.status, found.failed_step, best(k), ...
                       found.sweeps, found.products);
  end
end
printf("{\"octave\": \"%s\", \"blas\": \"%s\", \"n\": %d, \"product_seconds\": %.6g, \"cells\": [%s]}\n", ...
       version(), strtrim(version("-blas")), n, seconds_of_product(W0), strjoin(texts, ", "));
exit(status);
