# SPDX-License-Identifier: MIT
"""The fit of fit.sh by scikit-learn: prints the median milliseconds and the log marginal likelihood reached."""
import statistics
import sys
import time
import warnings

import numpy
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

warnings.filterwarnings("ignore")  # it complains of hyperparameters at their bounds
data = numpy.loadtxt(sys.argv[1], delimiter=",", skiprows=1)
milliseconds = []
for _ in range(int(sys.argv[2])):
    wide = (1e-10, 1e5)
    kernel = ConstantKernel(1.0, wide) * RBF(1.0, wide) + WhiteKernel(1e-2, wide)
    regressor = GaussianProcessRegressor(kernel, alpha=0.0)
    start = time.perf_counter()
    regressor.fit(data[:, :2], data[:, 2])
    milliseconds.append(1e3 * (time.perf_counter() - start))
print(f"{statistics.median(milliseconds):.4f} {regressor.log_marginal_likelihood_value_:.6f}")
