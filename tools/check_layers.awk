# The rules of tools/check_layers. First file: the table; the others: sources, paths from the root.

function bad(what) {
  printf "%s:%d: %s\n", FILENAME, FNR, what
  broken++
}

function bad_table(what) {
  printf "%s:%d: %s\n", FILENAME, FNR, what > "/dev/stderr"
  table_broken = 1
  exit 2
}

# The line without comments and without the insides of strings and character constants;
# remembers an open block comment or raw string in `open_until`.
function code_of(line,   out, at, rest, mark, delimiter) {
  out = ""
  while (line != "") {
    if (open_until != "") {
      at = index(line, open_until)
      if (at == 0) return out
      line = substr(line, at + length(open_until))
      open_until = ""
      continue
    }
    # a quote between digits (1'000) separates digits and opens nothing
    gsub(/[0-9]'[0-9]/, "0", line)
    if (!match(line, /\/\/|\/\*|R"|"|'/)) return out line
    mark = substr(line, RSTART, RLENGTH)
    out = out substr(line, 1, RSTART - 1)
    rest = substr(line, RSTART + RLENGTH)
    if (mark == "//") return out
    if (mark == "/*") {
      open_until = "*/"
      out = out " "
    } else if (mark == "R\"") {
      delimiter = substr(rest, 1, index(rest, "(") - 1)
      open_until = ")" delimiter "\""
      rest = substr(rest, length(delimiter) + 2)
    } else if (mark == "\"") {
      if (!match(rest, /^([^"\\]|\\.)*"/)) return out
      out = out "\"\""
      rest = substr(rest, RLENGTH + 1)
    } else {
      if (!match(rest, /^([^'\\]|\\.)*'/)) return out
      out = out "0"
      rest = substr(rest, RLENGTH + 1)
    }
    line = rest
  }
  return out
}

# The layer of a file in folders of terms: its first word says it.
function layer_of_term(path,   name) {
  name = path
  sub(/.*\//, "", name)
  sub(/[_.].*/, "", name)
  return name in layer_of_word ? layer_of_word[name] : layer_of_word["*"]
}

function check_include(line,   name, parts, of) {
  if (!match(line, /[<"][^>"]*[>"]/)) {
    bad("an #include must name its file")
    return
  }
  name = substr(line, RSTART + 1, RLENGTH - 2)
  quoted = substr(line, RSTART, 1) == "\""
  if (name ~ /^vbond\//) {
    split(name, parts, "/")
    of = parts[2] == "terms" ? layer_of_term(name) : parts[2]
    if (!(of in folder))
      bad("\"" name "\": no layer '" of "' in tools/layers.txt")
    else if (of != layer && !((layer, of) in allowed))
      bad(layer " must not include " of ": \"" name "\" (tools/layers.txt)")
    if (name ~ /\/detail\// && FILENAME ~ /\.hpp$/ && FILENAME !~ /\/detail\//)
      bad("\"" name "\" is not installed: only .cpp files may include it")
  } else if (quoted && (layer != "app" && layer != "python" || name ~ /\.\./)) {
    bad("write \"vbond/LAYER/NAME.hpp\", not \"" name "\": the layer must be visible")
  } else if (!quoted && in_library && FILENAME ~ /\.hpp$/ && FILENAME !~ /\/detail\// &&
             name !~ /^[a-z0-9_]+$/ && name != "immintrin.h") {  # the compiler's own
    bad("<" name "> in a header of the library: users would need it too; include it in a .cpp")
  }
}

# Which particle it is whose place ends a text or, at the "begin", begins it; "": there is no place. Places are
# r[i], r_0[i], positions[i], pose[i].r, i.r, i->r, pose_of(i).r, r(i) and r_i.
function particle_of(text, at,   name, inside, place) {
  name = "[A-Za-z_][A-Za-z0-9_.]*"
  inside = "\\[[^][]*(\\[[^][]*\\][^][]*)?\\]"
  place = "(" name "(" inside "|\\([A-Za-z0-9_.]*\\))?(\\.|->)r|(" name "\\.)?(r|r_[a-z0-9_]*|positions?|places?)" inside \
          "|r\\([A-Za-z0-9_.]*\\)|r_[a-z])"
  if (at == "begin") {
    if (!match(text, "^" place) || substr(text, RLENGTH + 1) ~ /^[A-Za-z0-9_.([]/) return ""
    text = substr(text, 1, RLENGTH)
  } else {
    if (!match(text, "(^|[^A-Za-z0-9_.>])" place "$")) return ""
    text = substr(text, RSTART)
    sub(/^[^A-Za-z_]/, "", text)
  }
  if (match(text, /[[(].*[])]/)) return substr(text, RSTART + 1, RLENGTH - 2)
  sub(/(\.|->)r$/, "", text)
  sub(/^r_/, "", text)
  return text
}

# The place of one particle less that of another: its own place at another time is not meant.
function check_placement(line,   at, left, right) {
  for (; (at = index(line, " - ")) > 0; line = substr(line, at + 3)) {
    left = particle_of(substr(line, 1, at - 1), "end")
    right = particle_of(substr(line, at + 3), "begin")
    if (left == "" || right == "" || left == right) continue
    bad("places of two particles: how they stand to each other is between() of core/cell.hpp")
    return
  }
}

FNR == 1 && NR > 1 {
  if (open_until != "") open_until = ""
  unfinished = ""
  layer = ""
  for (name in folder)
    if (index(FILENAME, folder[name] "/") == 1) layer = name
  if (index(FILENAME, "src/vbond/terms/") == 1) layer = layer_of_term(FILENAME)
  in_library = FILENAME ~ /^src\//
  if (layer == "") bad("in no folder of tools/layers.txt")
}

NR == FNR {  # the table
  if (/^[ \t]*(#|$)/) next
  if ($1 == "term") {
    if (!($3 in folder)) bad_table("no layer '" $3 "' above")
    layer_of_word[$2] = $3
    next
  }
  if (NF < 2) bad_table("expected: layer folder [allowed layers]")
  if ($1 in folder) bad_table("layer '" $1 "' twice")
  for (i = 3; i <= NF; i++) {
    if (!($i in folder)) bad_table("'" $1 "' may not include '" $i "', which is not above it")
    allowed[$1, $i] = 1
  }
  folder[$1] = $2
  next
}

{
  was_open = open_until != ""
  code = code_of($0)
  if (!was_open && $0 ~ /^[ \t]*#[ \t]*include/) check_include($0)
  if (layer == "") next
  if (code ~ /^[ \t]*#[ \t]*define/) {
    macro = code
    sub(/^[ \t]*#[ \t]*define[ \t]+/, "", macro)
    sub(/[^A-Za-z0-9_].*/, "", macro)
    if (macro != "VBOND_HD" || FILENAME != folder["core"] "/portable.hpp")
      bad("macro " macro ": VBOND_HD in core/portable.hpp is the only one")
  }
  if (FILENAME != folder["core"] "/cell.hpp") {
    sub(/^[ \t]+/, "", code)
    check_placement(unfinished code)
    unfinished = code ~ / -$/ ? code " " : ""  # goes on in the next line
  }
  if (in_library) {
    if (code ~ /(^|[^A-Za-z0-9_])(cout|cerr|clog|stdout|stderr)([^A-Za-z0-9_]|$)/ ||
        code ~ /(^|[^A-Za-z0-9_])(printf|vprintf|puts|putchar|perror|fmt::print|fmt::println)[ \t]*\(/)
      bad("the library never prints: write to a stream that the caller gives")
    if (code ~ /(^|[^A-Za-z0-9_.>])(exit|_exit|_Exit|quick_exit|abort|terminate)[ \t]*\(/)
      bad("the library never exits: throw instead")
  }
}

END {
  if (table_broken) exit 2
  if (broken) exit 1
}
