// engine/polynomial/sparse_fit.h — least squares with few terms, which are chosen one after the other.
#pragma once
#include <Eigen/Core>
#include <vector>

namespace lensproof::polynomial {

struct SparseFit {
    std::vector<Eigen::Index> terms;  // columns, in the order in which they were chosen
    Eigen::VectorXd coefficients;     // of these
    double rms = 0.0;                 // of what is left of the target, over the rows less the terms
};

/// The columns whose combination comes within `wanted` of the target (rms over the rows), or `most_terms` of them.
/// Each term is the one that leaves least of the target once all of them are fitted again (orthogonal least squares:
/// Chen, Billings & Luo, Int. J. Control 50, 1989), found on the normal equations: their error, of a square of the
/// columns' condition, has no say but in which of two like columns is taken. The coefficients come from an orthogonal
/// factorisation of the columns themselves.
SparseFit sparse_fit(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target, double wanted, int most_terms);

}  // namespace lensproof::polynomial
