function [W1, rule, products] = isospectral_midpoint(W0, h, a, b, laplacian, tolerance)
  % Returns the step W1 of the isospectral midpoint rule, how its iteration ended, and its matrix products.
  %
  %   Wt = W0 + (h/2) [B, Wt] + (h^2/4) B Wt B,   B = B(Wt)
  %   W1 = W0 + h [B, Wt],   [B, Wt] = M - M' with M = B Wt
  % This is the algebra formulation for s = 1, with X and K eliminated. a and b are those of s = 1, and not read.
  Wt = W0;
  products = 0;
  rule = [];
  do
    B = poisson_solve(laplacian, Wt);
    M = B*Wt;
    Wt_new = W0 + h/2*(M - M') + h^2/4*(M*B);
    products = products + 2;
    change = norm(Wt_new - Wt, "fro");
    Wt = Wt_new;
    rule = stopping_rule(rule, change, tolerance);
  until !strcmp(rule.status, "iterating")

  M = poisson_solve(laplacian, Wt)*Wt;
  W1 = W0 + h*(M - M');
  products = products + 1;
end
