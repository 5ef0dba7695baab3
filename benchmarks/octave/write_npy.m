function write_npy(path, W)
  % Writes a square complex matrix as a NumPy file: complex128, C order.
  file = fopen(path, "w", "ieee-le");
  if file < 0
    error("%s: cannot be written", path);
  end
  n = rows(W);
  header = sprintf("{'descr': '<c16', 'fortran_order': False, 'shape': (%d, %d), }", n, n);
  header = [header, repmat(" ", 1, 117 - numel(header)), "\n"];  % 128 bytes in all
  fwrite(file, [147, double("NUMPY"), 1, 0], "uint8");
  fwrite(file, numel(header), "uint16");
  fwrite(file, header, "uint8");
  entries = W.';
  fwrite(file, [real(entries(:))'; imag(entries(:))'], "double");
  fclose(file);
end
