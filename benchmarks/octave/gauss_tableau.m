function [a, b] = gauss_tableau(s)
  % Returns the s-stage Gauss tableau, s = 1, 2 or 3: a is s x s, b is 1 x s.
  % Source: Hairer, Lubich, Wanner, Geometric Numerical Integration, II.1.3.
  r3 = sqrt(3);
  r15 = sqrt(15);
  switch s
    case 1
      a = 1/2;
      b = 1;
    case 2
      a = [1/4,        1/4 - r3/6
           1/4 + r3/6, 1/4];
      b = [1/2, 1/2];
    case 3
      a = [5/36,          2/9 - r15/15, 5/36 - r15/30
           5/36 + r15/24, 2/9,          5/36 - r15/24
           5/36 + r15/30, 2/9 + r15/15, 5/36];
      b = [5/18, 4/9, 5/18];
    otherwise
      error("gauss_tableau: s = %d, must be 1, 2 or 3", s);
  end
end
