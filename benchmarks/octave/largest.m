function value = largest(values)
  % Returns the largest of some numbers, or NaN if any is NaN, which max would pass over.
  value = max(values);
  if any(isnan(values))
    value = NaN;
  end
end
