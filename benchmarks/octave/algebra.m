function [W1, rule, products] = algebra(W0, h, a, b, laplacian, tolerance)
  % Returns the step W1 of the algebra formulation (ISOSYRK), how its iteration ended, and its matrix products.
  %
  %   X_i  = -h (W0 + sum_j a_ij X_j) B_i,   B_j = B(Wt_j)
  %   K_ij =  h B_j (sum_k a_ik X_k + sum_k a_jk K_ik)
  %   Wt_i = W0 + sum_j a_ij (X_j - X_j' + K_ij)
  %   W1   = W0 + h sum_i b_i (C_i - C_i'),   C_i = B_i Wt_i
  % Source: the paper's ISOSYRK equations, with B_j for the printed B_i in K_ij, and J = I.
  n = rows(W0);
  s = columns(b);
  X = cell(1, s);
  K = cell(s, s);
  Wt = cell(1, s);
  for i = 1:s
    X{i} = zeros(n);
    Wt{i} = W0;
    for j = 1:s
      K{i, j} = zeros(n);
    end
  end
  B = cell(1, s);
  X_new = cell(1, s);
  K_new = cell(s, s);
  products = 0;
  rule = [];
  do
    for i = 1:s
      B{i} = poisson_solve(laplacian, Wt{i});
    end
    change = 0;
    for i = 1:s
      X_sum = zeros(n);
      for j = 1:s
        X_sum = X_sum + a(i, j)*X{j};
      end
      X_new{i} = -h*((W0 + X_sum)*B{i});
      products = products + 1;
      change = largest([change, norm(X_new{i} - X{i}, "fro")]);
      for j = 1:s
        K_sum = X_sum;
        for k = 1:s
          K_sum = K_sum + a(j, k)*K{i, k};
        end
        K_new{i, j} = h*(B{j}*K_sum);
        products = products + 1;
        change = largest([change, norm(K_new{i, j} - K{i, j}, "fro")]);
      end
    end
    X = X_new;
    K = K_new;
    for i = 1:s
      Wt_new = W0;
      for j = 1:s
        Wt_new = Wt_new + a(i, j)*(X{j} - X{j}' + K{i, j});
      end
      change = largest([change, norm(Wt_new - Wt{i}, "fro")]);
      Wt{i} = Wt_new;
    end
    rule = stopping_rule(rule, change, tolerance);
  until !strcmp(rule.status, "iterating")

  W1 = W0;
  for i = 1:s
    C = poisson_solve(laplacian, Wt{i})*Wt{i};
    W1 = W1 + h*b(i)*(C - C');
    products = products + 1;
  end
end
