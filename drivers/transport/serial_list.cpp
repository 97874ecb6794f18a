// The serial ports that are plugged in.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/serial_list.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <grp.h>
#include <libserialport.h>
#include <map>
#include <memory>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

namespace scansion {
namespace {

namespace fs = std::filesystem;

constexpr unsigned kHokuyoVendor = 0x15D1;

std::string text_of(const char* text) {
  return text == nullptr ? std::string() : std::string(text);
}

/// Device path to its name below /dev/serial/by-id.
std::map<std::string, std::string> stable_names() {
  std::map<std::string, std::string> out;
  std::error_code error;
  for (fs::directory_iterator at("/dev/serial/by-id", error), end; !error && at != end; at.increment(error)) {
    std::error_code dangling;
    const fs::path real = fs::canonical(at->path(), dangling);
    if (!dangling) out.emplace(real.string(), at->path().string());
  }
  return out;
}

/// Whether a program holds the lock that scansiond and others take. Opening the port to find out would raise its DTR line,
/// which restarts many a machine.
bool is_locked(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return false;
  char wanted[64];
  std::snprintf(wanted, sizeof wanted, " %02x:%02x:%llu ", major(status.st_dev), minor(status.st_dev),
                static_cast<unsigned long long>(status.st_ino));
  std::ifstream locks("/proc/locks");
  for (std::string row; std::getline(locks, row);) {
    if (row.find("FLOCK") != std::string::npos && row.find(wanted) != std::string::npos) return true;
  }
  return false;
}

std::string group_name(gid_t group) {
  char buffer[1024];
  struct group entry {};
  struct group* found = nullptr;
  if (::getgrgid_r(group, &entry, buffer, sizeof buffer, &found) != 0 || found == nullptr) return std::to_string(group);
  return entry.gr_name;
}

SerialPortInfo describe(sp_port* port, const std::map<std::string, std::string>& names) {
  SerialPortInfo out;
  out.path = text_of(sp_get_port_name(port));
  out.description = text_of(sp_get_port_description(port));
  const auto name = names.find(out.path);
  out.selector = name == names.end() ? out.path : name->second;
  if (sp_get_port_transport(port) == SP_TRANSPORT_USB) {
    int vendor = 0;
    int product = 0;
    if (sp_get_port_usb_vid_pid(port, &vendor, &product) == SP_OK) {
      out.vendor_id = static_cast<unsigned>(vendor);
      out.product_id = static_cast<unsigned>(product);
    }
    out.manufacturer = text_of(sp_get_port_usb_manufacturer(port));
    out.product = text_of(sp_get_port_usb_product(port));
    out.serial = text_of(sp_get_port_usb_serial(port));
  }
  const bool is_hokuyo = out.vendor_id == kHokuyoVendor || out.manufacturer.find("Hokuyo") != std::string::npos;
  if (is_hokuyo) out.driver = "hokuyo-scip";
  check_access(out.path, out.problem, out.fix);
  return out;
}

} // namespace

void check_access(const std::string& path, std::string& problem, std::string& fix) {
  problem.clear();
  fix.clear();
  if (::access(path.c_str(), R_OK | W_OK) == 0) {
    if (is_locked(path)) {
      problem = "in use by another program";
      fix = "stop that program; a running scansiond shows its devices with `scansion status`";
    }
    return;
  }
  const int reason = errno;
  struct stat status {};
  if (reason != EACCES || ::stat(path.c_str(), &status) != 0) {
    problem = system_error("cannot be opened", reason).context;
    return;
  }
  problem = "permission denied";
  const bool by_group = (status.st_mode & (S_IRGRP | S_IWGRP)) == (S_IRGRP | S_IWGRP) && status.st_gid != 0;
  if (by_group) {
    fix = "sudo adduser $USER " + group_name(status.st_gid) + ", then log in again";
  } else {
    fix = "give the port to the group dialout by a udev rule, /etc/udev/rules.d/60-scansion.rules: "
          "SUBSYSTEM==\"tty\", KERNEL==\"" +
          fs::path(path).filename().string() +
          "\", GROUP=\"dialout\", MODE=\"0660\"; then sudo udevadm control --reload && "
          "sudo udevadm trigger";
  }
}

Result<std::vector<SerialPortInfo>> list_serial_ports() {
  sp_port** list = nullptr;
  if (sp_list_ports(&list) != SP_OK) return system_error("cannot list the serial ports", errno);
  const std::unique_ptr<sp_port*, void (*)(sp_port**)> ports(list, sp_free_port_list);
  const auto names = stable_names();
  std::vector<SerialPortInfo> out;
  for (sp_port** port = list; *port != nullptr; ++port) out.push_back(describe(*port, names));
  std::sort(out.begin(), out.end(), [](const SerialPortInfo& a, const SerialPortInfo& b) { return a.path < b.path; });
  return out;
}

} // namespace scansion
