# awk -f compare_history.awk ONE OTHER: whether two history.csv have the same rows to 1e-10 of their scale: of energies
# the largest of all, of the components of a vector or tensor the largest of them, of forces and moments at least a
# thousandth of the largest energy over a spacing, which is 1, of others that of the column.
# Prints what differs most, in that scale.
BEGIN { FS = ","; tolerance = 1e-10 }
function size(x) { return x < 0 ? -x : x }
FNR == 1 {
  if (NR == 1) { header = $0; columns = split($0, name, ",") }
  else if ($0 != header) { print "columns differ"; bad = 1; exit }
  next
}
NR == FNR { rows = FNR; for (c = 1; c <= columns; ++c) one[FNR, c] = $c; next }
{ others = FNR; for (c = 1; c <= columns; ++c) other[FNR, c] = $c }
function scale_of(c, group) {
  if (name[c] ~ /^(kinetic|U_|contact$|dissipated|work|total|released)/) return "energy"
  group = name[c]
  sub(/\.[fmFM]?[xyz][xyz]?$/, "", group)
  if (group ~ /^cell_(strain|stress)_/) sub(/_[xyz][xyz]$/, "", group)
  return name[c] ~ /\.[mM][xyz]$/ ? group " moment" : group
}
END {
  if (bad) exit 1
  if (rows != others || rows < 3) { print rows " and " others " rows"; exit 1 }
  for (c = 1; c <= columns; ++c)
    for (r = 2; r <= rows; ++r)
      if (size(one[r, c]) > scale[scale_of(c)]) scale[scale_of(c)] = size(one[r, c])
  for (c = 1; c <= columns; ++c) {  # moments are of forces at arms of a spacing and more, which is 1
    group = scale_of(c)
    if (sub(/ moment$/, "", group) && scale[group] > scale[group " moment"]) scale[group " moment"] = scale[group]
  }
  for (c = 1; c <= columns; ++c)  # what balances leaves rounding alone
    if (name[c] ~ /\.[fmFM][xyz]$/ && scale[scale_of(c)] < 1e-3 * scale["energy"])
      scale[scale_of(c)] = 1e-3 * scale["energy"]
  scale["balance_error"] = 1
  for (r = 2; r <= rows; ++r) {  # it is a part of the largest energy so far: here of the largest of all
    so_far[r] = so_far[r - 1]
    for (c = 1; c <= columns; ++c)
      if (scale_of(c) == "energy" && size(one[r, c]) > so_far[r]) so_far[r] = size(one[r, c])
  }
  for (c = 1; c <= columns; ++c)
    for (r = 2; r <= rows; ++r) {
      d = size(one[r, c] - other[r, c])
      if (name[c] == "balance_error" && scale["energy"] > 0) d *= so_far[r] / scale["energy"]
      s = scale[scale_of(c)]
      if (d > 0 && d / (s > 0 ? s : 1e-300) >= worst) { worst = d / (s > 0 ? s : 1e-300); at = name[c] " in row " r }
    }
  print worst + 0 " (" at ")"
  exit !(worst <= tolerance)
}
