#include "support/judges.h"

#include <cstdlib>

#include "support/shared_data.h"

namespace apriltrack::test {

bool succeeds(const std::string& command) {
  return std::system(("(" + command + ") >/dev/null 2>&1").c_str()) == 0;
}

Judge program_judge(const std::string& program, const std::string& package) {
  return {program, package, succeeds("command -v " + program)};
}

namespace {

bool has_modules(const std::string& python, const std::string& modules) {
  return succeeds(python + " -c 'import " + modules + "'");
}

}  // namespace

std::string python_with(const std::string& modules) {
  const std::string of_debian = "/usr/bin/python3";
  return has_modules(of_debian, modules) ? of_debian : "python3";
}

Judge python_judge(const std::string& modules, const std::string& package) {
  return {"Python's " + modules, package, has_modules(python_with(modules), modules)};
}

std::string node() {
  return "NODE_PATH=\"$NODE_PATH:" + source_path("build/judges/node_modules").string() + "\" node";
}

std::vector<Judge> node_judges(const std::vector<std::string>& packages) {
  std::vector<Judge> judges = {program_judge("node", "nodejs")};
  for (const std::string& package : packages)
    judges.push_back(
        {package, package + " of npm", succeeds(node() + " -e \"require.resolve('" + package + "')\"")});
  return judges;
}

std::string missing_judge(const std::vector<Judge>& judges) {
  for (const Judge& judge : judges)
    if (!judge.is_there)
      return judge.name + " is not installed (package " + judge.package +
             "; `scripts/setup --judges` installs what this system has packages of)";
  return "";
}

bool are_judges_required() {
  const char* const value = std::getenv("APRILTRACK_JUDGES");
  return value != nullptr && std::string(value) == "required";
}

}  // namespace apriltrack::test
