/// kes_test: the Kawabata tests on a virtual specimen of a fabric file.
#include <sys/wait.h>

#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <sstream>
#include <string>

#include "fabric/fabric_search.h"
#include "fabric/yaml_reader.h"
#include "haptic_cloth/error.h"
#include "haptic_cloth/fabric.h"
#include "state/new_file.h"
#include "tools/command_line.h"
#include "tools/kes_values.h"
#include "tools/run_tool.h"
#include "tools/specimen.h"
#include "tools/standard_output.h"

namespace haptic_cloth {
namespace {

constexpr const char* kCsvHeader = "deformation,force,upper,lower\n";

/// First bytes of the pictures that matplotlib writes, by the end of their names.
const std::map<std::string, std::string> kPictures{
    {".pdf", "%PDF-"},
    {".png", "\x89PNG\r\n\x1a\n"},
    {".svg", "<?xml version=\"1.0\" encoding=\"utf-8\" standalone=\"no\"?>\n<!DOCTYPE svg"}};

constexpr const char* kDescription =
    "Virtual Kawabata (KES-F) tests of a fabric file on a mesh.\n"
    "Example: kes_test config/fabrics/denim_a.yaml --test bending --out bending.csv --plot bending.png";

constexpr const char* kFooter =
    "FILE.csv: deformation (strain, rad or 1/m), force on the mesh (N/m or N m/m), upper and lower branch "
    "of\n"
    "the fabric's loop there. Tension goes up to 500 gf/cm and back; shear to 8 deg and bending to 2.5/cm: "
    "up,\n"
    "down to the negative end and up again. Printed: what a KES instrument would read, in KES units.\n"
    "A file that is neither empty nor a curve or picture of the same kind is not replaced.\n"
    "Exit status: 0 success; 2 bad input, nothing written; 3 failure; 4 output cannot be written, for\n"
    "instance because the disk is full: then neither file of this run is there.";

struct Arguments {
  std::string fabric, out, plot, test;
  std::string direction = "warp", mesh = "finest";
};

const std::map<std::string, KesTest> kTests{
    {"tensile", KesTest::Tensile}, {"shear", KesTest::Shear}, {"bending", KesTest::Bending}};
const std::map<std::string, Direction> kDirections{{"warp", kWarp}, {"weft", kWeft}};
const std::map<std::string, SpecimenMesh> kMeshes{
    {"finest", SpecimenMesh::Finest}, {"coarsest", SpecimenMesh::Coarsest}, {"mixed", SpecimenMesh::Mixed}};

std::string pictureKind(const Arguments& arguments) {
  return std::filesystem::path(arguments.plot).extension().string();
}

/// @return false: help was printed instead
bool readArguments(int argc, char** argv, Arguments& arguments) {
  CommandLine line("kes_test", kDescription, "FABRIC", arguments.fabric,
                   "fabric file (YAML), or a name in config/fabrics");
  line.add("test", arguments.test, "NAME", "tensile, shear or bending; required");
  line.add("direction", arguments.direction, "NAME", "warp (default) or weft");
  line.add("mesh", arguments.mesh, "NAME", "finest (default), coarsest or mixed");
  line.add("out", arguments.out, "FILE.csv", "the curve");
  line.add("plot", arguments.plot, "FILE.png",
           "the curve beside the loop, also .pdf or .svg (needs python3-matplotlib)");
  line.setFooter(kFooter);
  if (!line.read(argc, argv)) return false;
  if (arguments.test.empty()) throw UsageError("--test is required");
  requireOneOf(kTests, "--test", arguments.test);
  requireOneOf(kDirections, "--direction", arguments.direction);
  requireOneOf(kMeshes, "--mesh", arguments.mesh);
  if (!arguments.plot.empty() && kPictures.count(pictureKind(arguments)) == 0)
    throw UsageError("--plot: " + arguments.plot + ": must end in .pdf, .png or .svg");
  return true;
}

std::string asCsv(const std::vector<KesRow>& rows) {
  std::ostringstream out;
  out.precision(17);
  out << kCsvHeader;
  for (const KesRow& row : rows) {
    out << row.deformation << ',' << row.force << ',' << row.upper << ',' << row.lower << '\n';
  }
  return out.str();
}

/// The text as one word of a shell command.
std::string shellWord(const std::string& text) {
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

/// Has the plot written under the temporary name of `file`.
void plotCurve(const NewFile& file, const std::string& csv, const Arguments& arguments) {
  std::string script = HAPTIC_CLOTH_SOURCE_SCRIPTS "/plot_kes.py";
  if (!std::filesystem::exists(script)) script = HAPTIC_CLOTH_INSTALL_SCRIPTS "/plot_kes.py";
  const std::string name = file.target().string();
  const std::string title = std::filesystem::path(arguments.fabric).stem().string() + ", " + arguments.test +
                            ", " + arguments.direction + ", " + arguments.mesh + " mesh";
  std::string command = "/usr/bin/python3";
  for (const std::string& word : {script, name, arguments.test, title, file.temporaryName()})
    command += ' ' + shellWord(word);
  FILE* python = popen(command.c_str(), "w");
  if (python == nullptr) throw std::runtime_error(command + ": cannot be started");
  std::fwrite(csv.data(), 1, csv.size(), python);
  const int status = pclose(python);
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNotWritten) throw OutputError(name, "");
  if (status != 0) throw std::runtime_error("--plot " + name + ": the plot failed");
}

int test(const Arguments& arguments) {
  if (!arguments.out.empty()) checkNewFile(arguments.out, kCsvHeader, "a curve of kes_test");
  if (!arguments.plot.empty()) {
    const std::string kind = pictureKind(arguments);
    checkNewFile(arguments.plot, kPictures.at(kind), "a " + kind.substr(1) + " picture");
    if (!arguments.out.empty() && linkedFile(arguments.out) == linkedFile(arguments.plot))
      throw UsageError("--plot: " + arguments.plot + ": must not be the file of --out");
  }
  const std::string found = findFabric(arguments.fabric, ".");
  if (found.empty() && !std::filesystem::exists(arguments.fabric))
    throw InputError(arguments.fabric, "", "", "must be a fabric file or one of " + joined(fabricNames(".")));
  const Fabric fabric = loadFabric(found.empty() ? arguments.fabric : found);
  const KesTest test = kTests.at(arguments.test);
  const Direction direction = kDirections.at(arguments.direction);
  if (loopOf(fabric, test, direction).isZero()) {
    throw InputError(arguments.fabric, arguments.test, "", "must have a stiffness or a loop for this test");
  }
  const std::vector<KesRow> rows = runKesTest(fabric, test, direction, kMeshes.at(arguments.mesh));
  const std::string csv = asCsv(rows);
  NewFiles files;
  if (!arguments.out.empty()) files.add(arguments.out).stream() << csv;
  if (!arguments.plot.empty()) plotCurve(files.add(arguments.plot), csv, arguments);
  files.publish();
  for (const auto& [name, value] : kesValues(rows, test)) std::cout << name << ' ' << value << '\n';
  const LoopAreas areas = loopAreas(rows, test);
  std::cout << "loop_area " << areas.measured << " J/m2 (fabric: " << areas.input << ")\n";
  requireStandardOutput();
  return kSuccess;
}

int run(int argc, char** argv) {
  Arguments arguments;
  return readArguments(argc, argv, arguments) ? test(arguments) : kSuccess;
}

}  // namespace
}  // namespace haptic_cloth

int main(int argc, char** argv) { return haptic_cloth::runTool("kes_test", haptic_cloth::run, argc, argv); }
