"""Gaussian process classification by the textbook, which shares nothing with the package but the mathematics."""

import numpy as np
from scipy.optimize import minimize
from scipy.special import erf, expit
from sklearn.gaussian_process._gpc import COEFS, LAMBDAS


def optimised_probability(features, targets, test, amplitude, length_scale):
    """R&W chapter 3 by the textbook formulas and a general optimiser; any targets, one class included."""

    def covariance(a, b):
        return amplitude * np.exp(-0.5 * ((a[:, None] - b[None]) ** 2).sum(axis=2) / length_scale**2)

    values, vectors = np.linalg.eigh(covariance(features, features))
    factor = vectors * np.sqrt(np.maximum(values, 0))  # f = factor z with z standard normal
    sign = 2 * targets - 1
    result = minimize(
        lambda z: 0.5 * z @ z + np.logaddexp(0, -sign * (factor @ z)).sum(),
        np.zeros(len(values)),
        jac=lambda z: z - factor.T @ (sign * expit(-sign * (factor @ z))),
        hess=lambda z: np.eye(len(z)) + (factor.T * (expit(factor @ z) * expit(-factor @ z))) @ factor,
        method='trust-exact',
        options={'gtol': 1e-11},
    )
    p = expit(factor @ result.x)
    cross = covariance(features, test)
    mean = cross.T @ (targets - p)
    root = np.sqrt(p * (1 - p))
    inverse = np.linalg.inv(np.eye(len(p)) + root[:, None] * covariance(features, features) * root)
    variance = amplitude - np.einsum('nk,nm,mk->k', cross, root[:, None] * inverse * root, cross)
    return (0.5 * COEFS * (1 + erf(LAMBDAS * mean / np.sqrt(1 + 2 * LAMBDAS**2 * variance)))).sum(axis=0)
