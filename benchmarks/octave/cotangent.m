function [W1, rule, products] = cotangent(W0, h, a, b, laplacian, tolerance)
  % Returns the step W1 of the cotangent formulation (T*G), how its iteration ended, and its matrix products.
  %
  %   Wt_i = Q_i' P_i,   B_i = B(Wt_i)
  %   Q_i  = I + h sum_j a_ij Q_j B_j',   P_i = W0 - h sum_j a_ij P_j B_j
  %   Q1   = I + h sum_j b_j Q_j B_j',    P1  = W0 - h sum_j b_j P_j B_j,    W1 = Q1' P1
  % Source: the paper's theorem, item 1.
  n = rows(W0);
  s = columns(b);
  I = eye(n);
  Q = cell(1, s);
  P = cell(1, s);
  QB = cell(1, s);
  PB = cell(1, s);
  for i = 1:s
    Q{i} = I;
    P{i} = W0;
  end
  products = 0;
  rule = [];
  do
    for j = 1:s
      B = poisson_solve(laplacian, Q{j}'*P{j});
      QB{j} = Q{j}*B';
      PB{j} = P{j}*B;
      products = products + 3;
    end
    change = 0;
    for i = 1:s
      Q_new = I;
      P_new = W0;
      for j = 1:s
        Q_new = Q_new + h*a(i, j)*QB{j};
        P_new = P_new - h*a(i, j)*PB{j};
      end
      change = largest([change, norm(Q_new - Q{i}, "fro"), norm(P_new - P{i}, "fro")]);
      Q{i} = Q_new;
      P{i} = P_new;
    end
    rule = stopping_rule(rule, change, tolerance);
  until !strcmp(rule.status, "iterating")

  Q1 = I;
  P1 = W0;
  for j = 1:s
    B = poisson_solve(laplacian, Q{j}'*P{j});
    Q1 = Q1 + h*b(j)*(Q{j}*B');
    P1 = P1 - h*b(j)*(P{j}*B);
    products = products + 3;
  end
  W1 = Q1'*P1;
  products = products + 1;
end
