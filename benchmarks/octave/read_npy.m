function W = read_npy(path)
  % Returns the square complex matrix in a NumPy file of version 1, complex128 in C order, as integrate --output writes.
  file = fopen(path, "r", "ieee-le");
  if file < 0
    error("%s: cannot be read", path);
  end
  magic = fread(file, 8, "uint8")';
  if !isequal(magic, [147, double("NUMPY"), 1, 0])
    fclose(file);
    error("%s: is no NumPy file of version 1", path);
  end
  header = fread(file, fread(file, 1, "uint16"), "uint8=>char")';
  numbers = fread(file, [2, Inf], "double");
  fclose(file);
  n = sqrt(columns(numbers));
  if isempty(strfind(header, "'<c16'")) || !isempty(strfind(header, "True")) || n != fix(n)
    error("%s: is no square matrix of complex128 in C order", path);
  end
  W = reshape(complex(numbers(1, :), numbers(2, :)), n, n).';
end
