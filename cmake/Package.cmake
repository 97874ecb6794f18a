# ./dev package: a Debian package of the three programs, the unit and the manual pages.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "Scansion developers <scansion@localhost>")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR}/package)
include(CPack)
