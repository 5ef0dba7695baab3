function [W1, rule, products] = group(W0, h, a, b, laplacian, tolerance)
  % Returns the step W1 of the group formulation (G), how its iteration ended, and its matrix products.
  %
  %   Wt_i = Q_i' W0 Q_i,   B_i = B(Wt_i)
  %   Q_i  = I + h sum_j a_ij Q_j B_j'
  %   Q1   = I + h sum_j b_j Q_j B_j',   W1 = Q1' W0 Q1
  % Source: the paper's theorem, item 3, with Q_k' for the printed Q_k, and J = I.
  n = rows(W0);
  s = columns(b);
  I = eye(n);
  Q = cell(1, s);
  QB = cell(1, s);
  for i = 1:s
    Q{i} = I;
  end
  products = 0;
  rule = [];
  do
    for j = 1:s
      B = poisson_solve(laplacian, Q{j}'*(W0*Q{j}));
      QB{j} = Q{j}*B';
      products = products + 3;
    end
    change = 0;
    for i = 1:s
      Q_new = I;
      for j = 1:s
        Q_new = Q_new + h*a(i, j)*QB{j};
      end
      change = largest([change, norm(Q_new - Q{i}, "fro")]);
      Q{i} = Q_new;
    end
    rule = stopping_rule(rule, change, tolerance);
  until !strcmp(rule.status, "iterating")

  Q1 = I;
  for j = 1:s
    B = poisson_solve(laplacian, Q{j}'*(W0*Q{j}));
    Q1 = Q1 + h*b(j)*(Q{j}*B');
    products = products + 3;
  end
  W1 = Q1'*(W0*Q1);
  products = products + 2;
end
