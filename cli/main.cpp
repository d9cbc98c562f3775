// SPDX-License-Identifier: GPL-3.0-or-later
// Parse, run one command, turn what went wrong into a message and an exit code. Nothing else catches errors.
#include "cli/command.h"
#include "cli/console_progress.h"
#include "cli/parse.h"
#include "core/errors.h"

#include <algorithm>
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

struct Talk {
  bool json = false;          ///< --json: what goes wrong is an object too
  bool json_written = false;  ///< the object has gone out already
};

int fail(const Talk& talk, int code, const std::string& message) {
  std::fputs(("dendrofit: " + message + "\n").c_str(), stderr);
  if (talk.json && !talk.json_written)
    std::fputs((dendrofit::cli::error_json(code, message) + "\n").c_str(), stdout);
  return code;
}

int run(const std::vector<std::string>& arguments, Talk& talk) {
  using namespace dendrofit::cli;
  const Invocation invocation = choose_command(arguments);
  CommonOptions common;
  OptionTable options;
  const auto command = invocation.row->make();
  command->declare(options);
  declare_common(options, common);
  parse_options(invocation, options, common);
  talk.json = common.json;
  ConsoleProgress progress(ConsoleProgress::style_for(common.progress, common.quiet), &stop_requested);
  Session session(invocation.row->name, common, options, progress);
  try {
    return command->run(session);
  } catch (const dendrofit::InputError& error) {
    talk.json_written = session.json_written();
    throw dendrofit::InputError(in_option_names(error.what(), options));
  } catch (...) {
    talk.json_written = session.json_written();
    throw;
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  Talk talk;
  talk.json = std::find(arguments.begin(), arguments.end(), "--json") != arguments.end();
  try {
    return run(arguments, talk);
  } catch (const dendrofit::cli::HelpRequested& help) {
    std::fputs(help.text.c_str(), stdout);
    return 0;
  } catch (const dendrofit::cli::UsageError& error) {
    return fail(talk, 2, error.what());
  } catch (const dendrofit::InputError& error) {
    return fail(talk, 3, error.what());
  } catch (const dendrofit::IoError& error) {
    return fail(talk, 3, error.what());
  } catch (const dendrofit::SolverError& error) {
    return fail(talk, 4, error.what());
  } catch (const dendrofit::Cancelled&) {
    return fail(talk, 130, "stopped; nothing is left half-written");
  } catch (const std::bad_alloc&) {
    return fail(talk, 1, "out of memory: thin the cloud first (--voxel), or give the program more memory");
  } catch (const std::exception& error) {
    return fail(talk, 1, std::string("internal fault, please report it: ") + error.what());
  }
}
