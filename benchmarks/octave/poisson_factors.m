function laplacian = poisson_factors(n, hbar)
  % Returns what poisson_solve needs for n x n matrices.
  %
  % -Delta maps every diagonal m >= 0 of W to itself, by a symmetric tridiagonal matrix of size n - m.  These matrices,
  % one behind the other, are a sparse matrix that is factored here once.
  %   factor  its upper Cholesky factor, sparse, n(n+1)/2 square
  %   order   places in W of the entries (1, 1+m), (2, 2+m) ... of diagonals m = 0, 1 ... n-1, one behind the other
  %   hbar    as given
  % Delta is that of Hoppe and Yau: Delta W = -sum_a [S_a, [S_a, W]], spin j = (n - 1)/2.
  j = (n - 1)/2;
  magnetic = j - (0:n-1)';
  ladder = sqrt(j*(j + 1) - magnetic.*(magnetic - 1));
  main = [];
  off = [];
  order = [];
  for m = 0:n-1
    i = (1:n-m)';
    d = 2*(j*(j + 1) - magnetic(i).*magnetic(i+m));
    e = -ladder(i).*ladder(i+m);
    e(n-m) = 0;  % diagonals do not couple
    if m == 0  % singular: the last unknown is pinned to 0
      d(n) = 1;
      e(n-1) = 0;
    end
    main = [main; d];
    off = [off; e];
    order = [order; i + n*(i + m - 1)];
  end
  N = numel(main);
  laplacian.factor = chol(spdiags([off, main, [0; off(1:N-1)]], -1:1, N, N));
  laplacian.order = order;
  laplacian.hbar = hbar;
end
