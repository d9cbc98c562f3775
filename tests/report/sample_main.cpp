// SPDX-License-Identifier: GPL-3.0-or-later
// report_sample OUT.html [SCAN_POINTS]: the made-up report, for the browser test and for looking at.
#include "core/atomic_file.h"
#include "tests/report/sample.h"

#include <cstdio>
#include <cstdlib>
#include <exception>

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: report_sample OUT.html [SCAN_POINTS]\n");
    return 2;
  }
  try {
    const dendrofit::test::Sample sample(argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 60'000);
    dendrofit::write_file(argv[1], dendrofit::make_report(sample.data));
  } catch (const std::exception& fault) {
    std::fprintf(stderr, "report_sample: %s\n", fault.what());
    return 3;
  }
  return 0;
}
