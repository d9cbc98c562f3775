// SPDX-License-Identifier: GPL-3.0-or-later
// The makers of every command (rows of the table in commands.cpp), and what several of them print.
#pragma once

#include "cli/command.h"
#include "core/metrics.h"
#include "core/tree.h"

#include <memory>

namespace dendrofit::cli {

std::unique_ptr<Command> make_run();
std::unique_ptr<Command> make_reconstruct();
std::unique_ptr<Command> make_growth();
std::unique_ptr<Command> make_fit();
std::unique_ptr<Command> make_grow();
std::unique_ptr<Command> make_leaves();
std::unique_ptr<Command> make_scan();
std::unique_ptr<Command> make_info();
std::unique_ptr<Command> make_convert();
std::unique_ptr<Command> make_view();

/// A forester's summary of a tree: height, DBH, volumes, crown, branches; with intervals where there are any.
void say_metrics(const Session& session, const Tree& tree, const TreeMetrics& metrics);

}  // namespace dendrofit::cli
