// SPDX-License-Identifier: GPL-3.0-or-later
// The examples for users of Python and R run on what we write.
#include "core/metrics.h"
#include "io/metrics_json.h"
#include "io/write_tree.h"
#include "tests/io/samples.h"

#include <cstdlib>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

bool runs(const std::string& command) {
  return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

void run_example(const std::string& command) {
  const test::TemporaryFolder folder;
  const Tree tree = test::random_tree(200, {500000, 5400000, 300});
  write_qsm_csv(folder / "qsm.csv", tree);
  write_metrics(folder / "metrics.json", measure(tree));
  EXPECT_TRUE(runs(command + " '" + (folder / "").string() + "'"));
}

const std::string kExamples = std::string(DENDROFIT_SOURCE_DIR) + "/scripts/examples/read_results";

TEST(Examples, PythonReadsResults) {
  for (const char* python : {"/usr/bin/python3", "python3"}) {
    if (!runs(std::string(python) + " -c 'import pandas'")) continue;
    return run_example(std::string(python) + " '" + kExamples + ".py'");
  }
  GTEST_SKIP() << "pandas is not here (apt-get install python3-pandas)";
}

TEST(Examples, RReadsResults) {
  if (!runs("Rscript -e 'library(jsonlite)'"))
    GTEST_SKIP() << "R is not here (apt-get install r-base-core r-cran-jsonlite)";
  run_example("Rscript '" + kExamples + ".R'");
}

}  // namespace
}  // namespace dendrofit
