// SPDX-License-Identifier: GPL-3.0-or-later
// What a fit found, in the words of its result. Internal to the fit of a tree.
#pragma once

#include "fit/fit_problem.h"
#include "fit/noise_metric.h"

namespace dendrofit {

/// Medians, intervals and identifiability of the posterior; `best` gives each parameter's value.
std::vector<FittedParameter> report_parameters(const FitProblem& problem, const PosteriorSample& posterior,
                                               const IgmParameters& best);

/// Pairs of identifiable or half-identifiable parameters whose posterior correlation is 0.6 or more.
std::vector<CorrelatedPair> report_correlations(const FitProblem& problem, const PosteriorSample& posterior);

std::vector<DescriptorFit> report_descriptors(const FitProblem& problem, const NoiseMetric& metric,
                                              const Eigen::MatrixXd& before, const Eigen::MatrixXd& after);

/// Adds what a user must know before relying on the result; nothing is identifiable where the model cannot
/// follow the tree.
void warn(const FitProblem& problem, const PosteriorSample& posterior, TreeFit& fit);

}  // namespace dendrofit
