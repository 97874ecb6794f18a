// scansion completion: a completion script for a shell, made from the command line itself.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/cli/command.hpp"

#include <cstdio>
#include <memory>

namespace scansion::cli {
namespace {

std::vector<std::string> long_options(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& w : words) text += (text.empty() ? "" : " ") + w;
  return text;
}

std::vector<std::string> verb_names(const CLI::App& root) {
  std::vector<std::string> names;
  for (const CLI::App* verb : root.get_subcommands([](const CLI::App*) { return true; })) names.push_back(verb->get_name());
  return names;
}

void print_bash(const CLI::App& root) {
  std::printf("_scansion() {\n  local word=${COMP_WORDS[COMP_CWORD]} verb=${COMP_WORDS[1]} words=\n"
              "  if [ \"$COMP_CWORD\" -eq 1 ]; then words=\"%s --help --version\"\n  else case $verb in\n",
              join(verb_names(root)).c_str());
  for (const CLI::App* verb : root.get_subcommands([](const CLI::App*) { return true; }))
    std::printf("    %s) words=\"%s\" ;;\n", verb->get_name().c_str(), join(long_options(*verb)).c_str());
  std::printf("  esac; fi\n  mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n}\n"
              "complete -o default -F _scansion scansion\n");
}

void print_zsh(const CLI::App& root) {
  std::printf("#compdef scansion\n_scansion() {\n  if (( CURRENT == 2 )); then compadd %s; return; fi\n  case $words[2] in\n",
              join(verb_names(root)).c_str());
  for (const CLI::App* verb : root.get_subcommands([](const CLI::App*) { return true; }))
    std::printf("    %s) compadd -- %s ;;\n", verb->get_name().c_str(), join(long_options(*verb)).c_str());
  std::printf("  esac\n  _files\n}\ncompdef _scansion scansion\n");
}

void print_fish(const CLI::App& root) {
  for (const CLI::App* verb : root.get_subcommands([](const CLI::App*) { return true; })) {
    std::printf("complete -c scansion -n __fish_use_subcommand -a %s -d '%s'\n", verb->get_name().c_str(),
                verb->get_description().c_str());
    for (const std::string& option : long_options(*verb))
      std::printf("complete -c scansion -n '__fish_seen_subcommand_from %s' -l %s\n", verb->get_name().c_str(),
                  option.c_str() + 2);
  }
}

} // namespace

Verb add_completion(CLI::App& root) {
  auto* app = root.add_subcommand("completion", "Print a completion script for a shell");
  auto shell = std::make_shared<std::string>();
  app->add_option("shell", *shell, "bash, zsh or fish")->required()->check(CLI::IsMember({"bash", "zsh", "fish"}));
  return {app, [shell, &root]() -> Result<int> {
            if (*shell == "bash") print_bash(root);
            if (*shell == "zsh") print_zsh(root);
            if (*shell == "fish") print_fish(root);
            return kDone;
          }};
}

} // namespace scansion::cli
