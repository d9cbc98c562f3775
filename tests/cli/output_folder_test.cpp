// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/output_folder.h"

#include "cli/parse.h"
#include "core/atomic_file.h"
#include "core/errors.h"
#include "tests/support/scratch_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit::cli {
namespace {

using ::testing::HasSubstr;

TEST(OutputFolder, is_made_and_never_overwritten_without_force) {
  const test::ScratchFolder scratch;
  CommonOptions common;
  EXPECT_TRUE(std::filesystem::is_directory(prepare_output_folder(scratch / "new" / "deep", common)));
  write_file(scratch / "new" / "deep" / "qsm.csv", "x");
  EXPECT_THROW(prepare_output_folder(scratch / "new" / "deep", common), UsageError);
  common.force = true;
  EXPECT_NO_THROW(prepare_output_folder(scratch / "new" / "deep", common));
  EXPECT_THROW(prepare_output_folder(scratch / "new" / "deep" / "qsm.csv", common), IoError);
  EXPECT_THROW(prepare_output_folder("", common), UsageError);
}

TEST(OutputFile, existing_files_and_missing_folders_are_refused) {
  const test::ScratchFolder scratch;
  CommonOptions common;
  EXPECT_NO_THROW(prepare_output_file(scratch / "a.las", common));
  write_file(scratch / "a.las", "x");
  EXPECT_THROW(prepare_output_file(scratch / "a.las", common), UsageError);
  EXPECT_THROW(prepare_output_file(scratch / "no" / "a.las", common), IoError);
  EXPECT_THROW(prepare_output_file(scratch.path(), common), IoError);
}

TEST(Checksum, is_the_common_crc32) {
  const test::ScratchFolder scratch;
  write_file(scratch / "a", "123456789");
  EXPECT_EQ(checksum(scratch / "a"), "cbf43926");
}

TEST(RunRecord, holds_options_seed_and_inputs_but_nothing_that_does_not_change_results) {
  const test::ScratchFolder scratch;
  write_file(scratch / "scan.las", "123456789");
  CommonOptions common;
  common.seed = 17;
  OptionTable options;
  double gap = 0.25;
  options.number("--gap", gap, Quantity::length, "a gap");
  declare_common(options, common);
  const Session session("reconstruct", common, options, no_progress());
  const std::string record = run_record(session, {scratch / "scan.las"});
  EXPECT_THAT(record, HasSubstr("gap = \"0.25m\""));
  EXPECT_THAT(record, HasSubstr("seed = 17"));
  EXPECT_THAT(record, HasSubstr("cbf43926"));
  EXPECT_THAT(record, ::testing::Not(HasSubstr("threads")));
}

}  // namespace
}  // namespace dendrofit::cli
