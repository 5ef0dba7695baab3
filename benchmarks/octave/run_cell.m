function [W, found] = run_cell(name, W0, h, steps, hbar, tolerance)
  % Returns W after so many steps of size h from W0 by a cell such as "group2", and what the run took.
  %
  % found.seconds is the CPU time of the steps, without set-up; found.sweeps and found.products count; found.status is
  % "converged", or how the step found.failed_step failed. The tolerance is relative to the state: W is held in units
  % of the power of two nearest to its 2-norm, which the algebra allows since B is linear.
  s = str2double(name(end));
  formulation = name(1:end-1);
  if s == 1 && strcmp(formulation, "algebra")
    formulation = "isospectral_midpoint";
  end
  [a, b] = gauss_tableau(s);
  laplacian = poisson_factors(rows(W0), hbar);
  unit = 2^round(log2(norm(W0)));
  W = W0/unit;
  step = str2func(formulation);
  found = struct("status", "converged", "seconds", 0, "sweeps", 0, "products", 0, "failed_step", 0);

  begun = cputime();
  for k = 1:steps
    [W, rule, products] = step(W, h*unit, a, b, laplacian, tolerance);
    found.sweeps = found.sweeps + rule.sweeps;
    found.products = found.products + products;
    if !strcmp(rule.status, "converged")
      found.status = rule.status;
      found.failed_step = k;
      break
    end
  end
  found.seconds = cputime() - begun;
  W = W*unit;
end
