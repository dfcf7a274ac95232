# Makes what all tests of the programs start from, in DIR: scan/ (24 frames of
# 160x120), dense.ply, small.flags (settings for a run of a second) and run/
# (the run folder of these settings). BIN: folder of the programs.
file(REMOVE_RECURSE ${DIR})
file(MAKE_DIRECTORY ${DIR})
file(WRITE ${DIR}/small.flags
"--partition_clusters=80
--simplify_faces=2000
--keyframe_window=2
--texel_size=0.02
--schedule=2x[C; Phi; T+F]
--stop_decrease=0
--previews=false
")

function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE code)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "exit code ${code}: ${ARGV}")
  endif()
endfunction()

run(${BIN}/facet-synthesize --output=${DIR}/scan --frames=24 --width=160
    --height=120)
run(${BIN}/facet-fuse --sequence=${DIR}/scan --output=${DIR}/dense.ply
    --voxel_size=0.08)
run(${BIN}/facet-reconstruct --flagfile=${DIR}/small.flags
    --sequence=${DIR}/scan --mesh=${DIR}/dense.ply --output=${DIR}/run)
