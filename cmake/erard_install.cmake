# What `cmake --install` lays down: headers, library, programs, default files, and the package for find_package(erard).
include(CMakePackageConfigHelpers)

set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/erard")

install(DIRECTORY "${PROJECT_SOURCE_DIR}/include/erard" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
        FILES_MATCHING PATTERN "*.hpp")
install(TARGETS erard EXPORT erardTargets INCLUDES DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
install(EXPORT erardTargets NAMESPACE erard:: DESTINATION "${package_dir}")

if(ERARD_BUILD_DEVICE)
  install(TARGETS erard_device EXPORT erardDeviceTargets ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
  install(EXPORT erardDeviceTargets NAMESPACE erard:: DESTINATION "${package_dir}")
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/config/" DESTINATION "${CMAKE_INSTALL_DATADIR}/erard")
endif()

if(ERARD_BUILD_LINK)
  install(TARGETS erard_link EXPORT erardLinkTargets ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
  install(EXPORT erardLinkTargets NAMESPACE erard:: DESTINATION "${package_dir}")
  install(DIRECTORY "${ERARD_MESSAGE_CPP_DIR}/erard" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
  install(FILES ${ERARD_MESSAGE_FILES} DESTINATION "${CMAKE_INSTALL_DATADIR}/erard/messages")
endif()

if(ERARD_BUILD_LANES)
  install(TARGETS erard_lanes EXPORT erardLanesTargets ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
  install(EXPORT erardLanesTargets NAMESPACE erard:: DESTINATION "${package_dir}")
endif()

if(ERARD_BUILD_SPARSE)
  install(TARGETS erard_sparse EXPORT erardSparseTargets ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
  install(EXPORT erardSparseTargets NAMESPACE erard:: DESTINATION "${package_dir}")
endif()

if(ERARD_BUILD_APPS)
  get_property(programs TARGET erard_programs PROPERTY ERARD_PROGRAMS)
  install(TARGETS ${programs} RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
endif()

configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/erardConfig.cmake.in"
                              "${PROJECT_BINARY_DIR}/erardConfig.cmake" INSTALL_DESTINATION "${package_dir}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/erardConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/erardConfig.cmake" "${PROJECT_BINARY_DIR}/erardConfigVersion.cmake"
        DESTINATION "${package_dir}")
