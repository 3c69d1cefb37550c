# erard_lcm_messages(<target>): C++ and Python of messages/*.lcm, made by lcm-gen when a file changes.
#   <build>/messages/cpp/erard/<type>.hpp       on the include path of the target and of all that link it
#   <build>/messages/python/erard/<type>.py     for PYTHONPATH
file(GLOB ERARD_MESSAGE_FILES CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/messages/*.lcm")
set(ERARD_MESSAGE_CPP_DIR "${PROJECT_BINARY_DIR}/messages/cpp")
set(ERARD_MESSAGE_PYTHON_DIR "${PROJECT_BINARY_DIR}/messages/python")

function(erard_lcm_messages target)
  foreach(file IN LISTS ERARD_MESSAGE_FILES)
    get_filename_component(type "${file}" NAME_WE)
    list(APPEND headers "${ERARD_MESSAGE_CPP_DIR}/erard/${type}.hpp")
    list(APPEND modules "${ERARD_MESSAGE_PYTHON_DIR}/erard/${type}.py")
  endforeach()
  # all types at once: with Python each call adds to one __init__.py
  add_custom_command(OUTPUT ${headers} ${modules}
    COMMAND "${CMAKE_COMMAND}" -E rm -rf "${ERARD_MESSAGE_PYTHON_DIR}"
    COMMAND "${ERARD_LCM_GEN}" --cpp --cpp-std=c++11 "--cpp-hpath=${ERARD_MESSAGE_CPP_DIR}"
            --python "--ppath=${ERARD_MESSAGE_PYTHON_DIR}" ${ERARD_MESSAGE_FILES}
    DEPENDS ${ERARD_MESSAGE_FILES}
    COMMENT "Generating the LCM message types"
    VERBATIM)
  add_custom_target(${target}_messages DEPENDS ${headers} ${modules})
  add_dependencies(${target} ${target}_messages)
  target_include_directories(${target} SYSTEM PUBLIC "$<BUILD_INTERFACE:${ERARD_MESSAGE_CPP_DIR}>")
endfunction()
