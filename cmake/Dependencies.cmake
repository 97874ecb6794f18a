# Every library the project uses, in one place, with the reason it is here. All are Debian 12 packages.
find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(ZLIB REQUIRED)                                  # CRC-32 of MCAP records
find_package(Boost 1.74 REQUIRED)                            # Outcome (errors as values), Asio (sockets, timers)
find_package(nlohmann_json 3.11 REQUIRED)                    # JSON messages and --json output
find_package(spdlog REQUIRED)                                # the daemon's log
find_package(fmt REQUIRED)                                   # spdlog's formatter
find_path(CLI11_INCLUDE_DIR CLI/CLI.hpp REQUIRED)            # command lines
find_path(TOMLPP_INCLUDE_DIR toml++/toml.h REQUIRED)         # the daemon's configuration
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)     # blobs and repeating planes of the codec
pkg_check_modules(ARCHIVE REQUIRED IMPORTED_TARGET libarchive) # tar, xz, gz, zst inputs
pkg_check_modules(SYSTEMD REQUIRED IMPORTED_TARGET libsystemd) # READY, STOPPING, WATCHDOG
pkg_check_modules(SERIALPORT REQUIRED IMPORTED_TARGET libserialport) # serial ports: custom rates, all adapters
pkg_check_modules(CAIRO REQUIRED IMPORTED_TARGET cairo)       # pictures of `scansion view`; the daemon does not link it
