# What `cmake --install` does before it installs anything; included before the targets, so that it runs first.
option(PCM_STRIP_INSTALL "Install programs and libraries without their debug information" ON)

# The list of installed files, which cmake writes into the build folder. One that root wrote is in the way of its owner.
install(CODE [[
if(CMAKE_INSTALL_COMPONENT)
  file(REMOVE "${CMAKE_CURRENT_LIST_DIR}/install_manifest_${CMAKE_INSTALL_COMPONENT}.txt")
else()
  file(REMOVE "${CMAKE_CURRENT_LIST_DIR}/install_manifest.txt")
endif()]] ALL_COMPONENTS)

if(PCM_STRIP_INSTALL)
  install(CODE "set(CMAKE_INSTALL_DO_STRIP ON)" ALL_COMPONENTS)
endif()
