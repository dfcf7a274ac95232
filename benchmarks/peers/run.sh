# Part of scripts/bench, which sources it: facet beside its peers on one mesh.
#
# A job is a line `name|label|reference|program|method|count` (a label without
# commas, for it becomes a cell of a CSV): the program runs
# as `bench-PROGRAM METHOD MESH COUNT OUTPUT`, and its time and memory are given
# as multiples of those of the job with the name `reference`.
peers_bin=build/release/bin
peers_repetitions=3

peers_build() {
  scripts/install --peers
  cmake --preset release -DFACET_BUILD_PEERS=ON -DFACET_BUILD_APPS=ON
  cmake --build --preset release --target peers facet-synthesize facet-fuse \
    facet-reconstruct
}

# A furnished room of the synthetic tools, about as large as a real scan.
peers_make_mesh() {
  local scan
  scan=$(dirname "$1")/scan
  "$peers_bin/facet-synthesize" --output="$scan" --frames=120 --overwrite
  "$peers_bin/facet-fuse" --sequence="$scan" --output="$1" --voxel_size=0.02
}

# user_s,wall_s,peak_mb,count of a run, from the lines of its stages.
peers_total() {
  awk -F, '
    NR > 1 { user += $2; wall += $3; count = $5; if ($4 > mb) mb = $4 }
    END { printf "%.2f,%.2f,%.0f,%d\n", user, wall, mb, count }
  ' "$1"
}

# peers_run OUT MESH NAME PROGRAM METHOD COUNT [SEQUENCE]: once more. OUT/NAME.csv
# and OUT/NAME.ply are of the run that took the least user time so far.
peers_run() {
  local best=$1/$3 new=$1/new
  OMP_NUM_THREADS=1 "$peers_bin/bench-$4" "$5" "$2" "$6" "$new.ply" ${7:+"$7"} \
    >"$new.csv"
  if [[ ! -s "$best.csv" ]] || awk -v new="$(peers_total "$new.csv")" \
    -v best="$(peers_total "$best.csv")" 'BEGIN { exit !(new + 0 < best + 0) }'
  then
    mv "$new.csv" "$best.csv"
    mv "$new.ply" "$best.ply"
  fi
}

# peers_measure OUT MESH JOBS [SEQUENCE]: jobs take turns, so that whatever else the machine
# does meets all of them.
peers_measure() {
  local repetition name label reference program method count
  for ((repetition = 1; repetition <= peers_repetitions; ++repetition)); do
    while IFS='|' read -r name label reference program method count; do
      echo "bench: peers: $label ($repetition of $peers_repetitions)"
      peers_run "$1" "$2" "$name" "$program" "$method" "$count" \
        "${4:-}" </dev/null
    done <<<"$3"
  done
}

# peers_table OUT JOBS EVALUATE ...: a row a job, the result of its program by
# `bench-peers-evaluate EVALUATE ... OUT/NAME.ply`. Leaves OUT/EVALUATE.csv.
peers_table() {
  local out=$1 jobs=$2 name label reference rest files=()
  shift 2
  while IFS='|' read -r name rest; do
    files+=("$out/$name")
    [[ -d "$out/$name" ]] || files[-1]+=.ply  # a run folder of facet
  done <<<"$jobs"
  "$peers_bin/bench-peers-evaluate" "$@" "${files[@]}" >"$out/quality.csv"
  { echo "name,tool,reference,user_s,wall_s,peak_mb,$(head -n 1 "$out/quality.csv")"
    paste -d '|' <(echo "$jobs") <(tail -n +2 "$out/quality.csv") |
      while IFS='|' read -r name label reference _ _ _ quality; do
        echo "$name,$label,$reference,$(peers_total "$out/$name.csv" |
          cut -d, -f1-3),$quality"
      done
  } | tee "$out/$1.csv" | peers_ratios
}

# Puts time and memory as multiples of the reference behind them.
peers_ratios() {
  awk -F, '
    { row[NR] = $0; user[$1] = $4; mb[$1] = $6 }
    END {
      for (i = 1; i <= NR; ++i) {
        n = split(row[i], cell, ",")
        time = i == 1 ? "time_ratio" : sprintf("%.2f", cell[4] / user[cell[3]])
        memory = i == 1 ? "memory_ratio" : sprintf("%.2f", cell[6] / mb[cell[3]])
        text = "| " cell[2] " |"
        for (k = 4; k <= 6; ++k) text = text " " cell[k] " |"
        text = text " " time " | " memory " |"
        for (k = 7; k <= n; ++k) text = text " " cell[k] " |"
        print text
        if (i > 1) continue
        gsub(/[^|]+/, "---", text)
        print text
      }
    }
  '
}

# peers_simplification OUT MESH: at 20,000 faces, and at as many as facet's own
# budget gives.
peers_simplification() {
  local own jobs peer
  peers_run "$1" "$2" facet-own facet-mesh simplify 0
  own=$(peers_total "$1/facet-own.csv" | cut -d, -f4)
  jobs="facet|facet|facet|facet-mesh|simplify|20000
facet-near|facet with plane share 0|facet|facet-mesh|simplify-near|20000
facet-own|facet with its own budget|facet|facet-mesh|simplify|0
facet-own-near|facet with its own budget and plane share 0|facet|facet-mesh|simplify-near|0"
  for peer in "open3d|Open3D quadric decimation" \
    "openmesh|OpenMesh quadrics and flip guard" \
    "meshoptimizer|meshoptimizer simplify"; do
    jobs+=$'\n'"${peer%|*}|${peer#*|}|facet|peer-${peer%|*}|simplify|20000"
    jobs+=$'\n'"${peer%|*}-own|${peer#*|}|facet|peer-${peer%|*}|simplify|$own"
  done
  peers_measure "$1" "$2" "$jobs" >&2
  peers_table "$1" "$jobs" simplification "$2"
}

# peers_partition OUT MESH
peers_partition() {
  local jobs="facet-1000|facet|facet-1000|facet-mesh|partition|1000
facet-2000|facet|facet-2000|facet-mesh|partition|2000
merged-2000|facet merged from 2000|facet-2000|facet-mesh|merge|2000
vsa-1000|CGAL VSA|facet-1000|peer-cgal|vsa|1000
vsa-2000|CGAL VSA|facet-2000|peer-cgal|vsa|2000
regions|CGAL region growing|facet-1000|peer-cgal|region-growing|50"
  peers_measure "$1" "$2" "$jobs" >&2
  peers_table "$1" "$jobs" partition
}

# peers_color OUT MESH SEQUENCE: once each, for it takes minutes. Held out are the
# frames that held_out.h names.
peers_color() {
  local jobs="color-mean|mean colour without optimisation|color-facet|peer-color-map|rigid|0
color-rigid|Open3D rigid|color-facet|peer-color-map|rigid|50
color-warped|Open3D non-rigid|color-facet|peer-color-map|non-rigid|50"
  peers_repetitions=1 peers_measure "$1" "$2" "$jobs" "$3" >&2
  echo "bench: peers: facet-reconstruct" >&2
  "$peers_bin/facet-reconstruct" --sequence="$3" --mesh="$2" --threads=1 \
    --output="$1/color-facet" --overwrite --holdout_stride=25 \
    --holdout_offset=7 >&2
  "$peers_bin/bench-peers-evaluate" stages "$1/color-facet" \
    >"$1/color-facet.csv"
  jobs+=$'\n'"color-facet|facet with all its stages|color-facet|||"
  peers_table "$1" "$jobs" color "$3"
}

# The stages of facet's simplification, in words.
peers_stages() {
  awk -F, '
    NR > 1 { text = text (NR > 2 ? ", " : "") $1 " " $2 " s (" $4 " MB)" }
    END { print "Stages of the first line: " text "." }
  ' "$1/facet.csv"
}

# The versions of the peers, as their packages have them.
peers_versions() {
  dpkg-query -W -f='${Package} ${Version}\n' libopen3d-dev libopenmesh-dev \
    libmeshoptimizer-dev libcgal-dev |
    sed -E 's/^lib([a-z0-9]+)-dev ([0-9.]+).*/\1 \2/' | paste -sd ';' |
    sed 's/;/, /g'
}

# peers_tables OUT MESH SEQUENCE TABLES FOOTER; without a sequence (empty) the
# table of colours stays as it is.
peers_tables() {
  local size footer
  rm -f "$1"/*.csv
  size=$("$peers_bin/bench-peers-evaluate" mesh "$2" | tail -n 1)
  footer="${size%,*} faces, ${size#*,} m^2; $5; $(peers_versions)."
  { peers_simplification "$1" "$2"
    printf '\n%s\n\n%s\n' "$(peers_stages "$1")" "$footer"
  } >"$4/peers-simplification"
  { peers_partition "$1" "$2"
    printf '\n%s\n' "$footer"
  } >"$4/peers-partition"
  [[ -n "$3" ]] || return 0
  { peers_color "$1" "$2" "$3"
    printf '\n%s\n' "$footer"
  } >"$4/peers-color"
}
