function B = poisson_solve(laplacian, W)
  % Returns B = Delta^-1 W / hbar for skew-Hermitian W, n x n; reads the upper triangle of W.
  %
  % The multiple of I in W, which is not in the range of Delta, is subtracted; B is trace-free.
  n = rows(W);
  main = 1:n;  % places of diagonal 0
  f = W(laplacian.order);
  f(main) = 1i*imag(f(main) - mean(f(main)));
  f(n) = 0;  % the unknown that is pinned
  x = laplacian.factor\(laplacian.factor'\f)/(-laplacian.hbar);
  x(main) = (x(main) - mean(x(main)))/2;  % halved: the next line adds both halves
  B = zeros(n);
  B(laplacian.order) = x;
  B = B - B';
end
