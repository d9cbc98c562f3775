// SPDX-License-Identifier: GPL-3.0-or-later
// The three ways a verb can refuse, and the one way a user can stop it. Caught once, in cli/main.cpp.
#pragma once

#include <stdexcept>
#include <string>

namespace dendrofit {

/// An argument, option or content that cannot be right. The message names the field (or file, line, byte),
/// what was found, what was expected and what to do. Exit code 3.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A file that cannot be read or written: missing, truncated, not what it claims to be. Exit code 3.
struct IoError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Sound input that gives no answer (too few points, no stem). The message says why in the field's words.
/// Exit code 4.
struct SolverError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The user asked to stop. Not an error: nothing derives from it and nothing but main catches it. Exit code
/// 130.
struct Cancelled {};

/// Throws InputError "field = value: limit" unless `holds`; the body of every options struct's validate().
void require(bool holds, const std::string& field, double value, const std::string& limit);

}  // namespace dendrofit
