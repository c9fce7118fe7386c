"""Engine of the classifiers: Gaussian processes under the Laplace approximation, and look-ahead in them."""
