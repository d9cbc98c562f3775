// SPDX-License-Identifier: GPL-3.0-or-later
// Parse, run one command, turn what went wrong into a message and an exit code. Nothing else catches errors.
#include "cli/command.h"
#include "cli/console_progress.h"
#include "cli/parse.h"
#include "core/errors.h"

#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

namespace {

std::atomic<bool> stop_requested{false};

/// The first Ctrl-C asks the running verb to stop; a second one ends the process the hard way.
void on_signal(int signal) {
  stop_requested = true;
  std::signal(signal, SIG_DFL);
}

int fail(int code, const std::string& message) {
  std::fputs(("dendrofit: " + message + "\n").c_str(), stderr);
  return code;
}

int run(const std::vector<std::string>& arguments) {
  using namespace dendrofit::cli;
  const Invocation invocation = choose_command(arguments);
  CommonOptions common;
  OptionTable options;
  const auto command = invocation.row->make();
  command->declare(options);
  declare_common(options, common);
  parse_options(invocation, options, common);
  ConsoleProgress progress(ConsoleProgress::style_for(common.progress, common.quiet), &stop_requested);
  Session session(invocation.row->name, common, options, progress);
  return command->run(session);
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  try {
    return run({argv + 1, argv + argc});
  } catch (const dendrofit::cli::HelpRequested& help) {
    std::fputs(help.text.c_str(), stdout);
    return 0;
  } catch (const dendrofit::cli::UsageError& error) {
    return fail(2, error.what());
  } catch (const dendrofit::InputError& error) {
    return fail(3, error.what());
  } catch (const dendrofit::IoError& error) {
    return fail(3, error.what());
  } catch (const dendrofit::SolverError& error) {
    return fail(4, error.what());
  } catch (const dendrofit::Cancelled&) {
    return fail(130, "stopped; nothing is left half-written");
  } catch (const std::bad_alloc&) {
    return fail(1, "out of memory: thin the cloud first (dendrofit convert IN OUT --voxel 5mm)");
  } catch (const std::exception& error) {
    return fail(1, std::string("internal fault, please report it: ") + error.what());
  }
}
