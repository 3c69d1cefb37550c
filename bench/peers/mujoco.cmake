# MuJoCo as a peer of erard-bench, where its C library is at hand; tools/install-peers puts it into build/peers.
#   ERARD_MUJOCO_DIR   folder with include/mujoco/mujoco.h and libmujoco.so.* ; empty: build/peers/mujoco of the source
set(ERARD_MUJOCO_DIR "" CACHE PATH "MuJoCo as unpacked from its wheel: include/mujoco and libmujoco.so.*")

set(folder "${ERARD_MUJOCO_DIR}")
if(NOT folder)
  set(folder "${PROJECT_SOURCE_DIR}/build/peers/mujoco")
endif()
file(GLOB library "${folder}/libmujoco.so*")

if(library AND EXISTS "${folder}/include/mujoco/mujoco.h")
  list(GET library 0 library)
  message(STATUS "Peer of erard-bench: ${library}")
  add_library(erard_mujoco SHARED IMPORTED)
  set_target_properties(erard_mujoco PROPERTIES IMPORTED_LOCATION "${library}")
  target_include_directories(erard_mujoco SYSTEM INTERFACE "${folder}/include")
  erard_embed_text(erard_bench peer_file FILES peers/action.xml)
  target_sources(erard_bench PRIVATE peers/mujoco.cpp)
  target_link_libraries(erard_bench PRIVATE erard_mujoco)
  set_target_properties(erard_bench PROPERTIES ERARD_PEER_FOLDER "${folder}")  # where an installed program finds it
elseif(ERARD_MUJOCO_DIR)
  message(FATAL_ERROR "ERARD_MUJOCO_DIR = ${ERARD_MUJOCO_DIR}: holds no include/mujoco/mujoco.h with libmujoco.so.*")
else()
  target_sources(erard_bench PRIVATE peers/no_mujoco.cpp)
endif()
