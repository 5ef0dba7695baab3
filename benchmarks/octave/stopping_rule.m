function rule = stopping_rule(rule, change, tolerance)
  % Returns the state of an iteration after a sweep with this change; begin with an empty one, [].
  %
  % rule.status is "iterating", "converged" (change below the tolerance), "diverged" (not finite, or above 1e6),
  % "stagnated" (the best change so far not improved in 50 sweeps) or "sweep cap" (1000); rule.sweeps counts.
  % change is the largest change of an unknown in the Frobenius norm.
  if isempty(rule)
    rule = struct("status", "iterating", "sweeps", 0, "best", Inf, "since_best", 0);
  end
  rule.sweeps = rule.sweeps + 1;
  if !(change <= 1e6)
    rule.status = "diverged";
  elseif change < tolerance
    rule.status = "converged";
  elseif change < rule.best
    rule.best = change;
    rule.since_best = 0;
  else
    rule.since_best = rule.since_best + 1;
    if rule.since_best >= 50
      rule.status = "stagnated";
    end
  end
  if strcmp(rule.status, "iterating") && rule.sweeps >= 1000
    rule.status = "sweep cap";
  end
end
