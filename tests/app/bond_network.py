"""Laboratory tests of small bodies by linear algebra alone: bonds between centres as springs of six directions, broken one by
one. It shares nothing with the program but the rules of the page on laboratory tests."""
import numpy as np


def across(e):
    return np.eye(3) - np.outer(e, e)


def skew(e):
    """The matrix of theta -> theta x e."""
    return np.array([[0, e[2], -e[1]], [-e[2], 0, e[0]], [e[1], -e[0], 0]])


class Network:
    """Particles r, pairs of them, and four stiffnesses (c_A, c_D, c_B, c_T), the same for all."""

    def __init__(self, r, pairs, stiffness, limits=None):
        self.r, self.pairs, self.c, self.limits = np.asarray(r, float), list(pairs), stiffness, limits
        self.whole = np.ones(len(self.pairs), bool)
        self.channels = [self.channels_of(i, j) for i, j in self.pairs]

    def channels_of(self, i, j):
        """Stretch, shear, bending and twist of a bond as matrices of the 12 numbers u_i, theta_i, u_j, theta_j."""
        e = self.r[j] - self.r[i]
        a = np.linalg.norm(e)
        e = e / a
        none, one, P, turn = np.zeros((3, 3)), np.eye(3), across(e), skew(e)
        stretch = np.concatenate([-e, np.zeros(3), e, np.zeros(3)])[None]
        shear = np.hstack([-P, -0.5 * a * turn, P, -0.5 * a * turn])
        bend = np.hstack([none, -P, none, P])
        twist = np.concatenate([np.zeros(3), -e, np.zeros(3), e])[None]
        return stretch, shear, bend, twist

    def matrix(self):
        n = 6 * len(self.r)
        K = np.zeros((n, n))
        for k, (i, j) in enumerate(self.pairs):
            if self.whole[k]:
                at = np.r_[6 * i:6 * i + 6, 6 * j:6 * j + 6]
                K[np.ix_(at, at)] += sum(c * B.T @ B for c, B in zip(self.c, self.channels[k]))
        return K

    def solve(self, held):
        """Displacements (particle, 6) with these values, {(particle, dof): value}, and the forces that hold them."""
        K = self.matrix()
        n = len(K)
        fixed = np.array([6 * p + d for p, d in held])
        x = np.zeros(n)
        x[fixed] = list(held.values())
        free = np.setdiff1d(np.arange(n), fixed)
        A = K[np.ix_(free, free)]
        # nothing holds rigid motions and single particles: a spring of 1e-10 to where they are
        A[np.diag_indices(len(free))] += 1e-10 * np.mean(np.diag(K))
        x[free] = np.linalg.solve(A, -K[np.ix_(free, fixed)] @ x[fixed])
        return x.reshape(-1, 6), (K @ x).reshape(-1, 6)

    def use(self, x):
        """What each bond uses of its strength by the criterion `linear`."""
        used = np.zeros(len(self.pairs))
        for k, (i, j) in enumerate(self.pairs):
            if self.whole[k]:
                q = np.concatenate([x[i], x[j]])
                N, V, M_b, M_t = (c * (B @ q) for c, B in zip(self.c, self.channels[k]))
                parts = max(N[0], 0), np.linalg.norm(V), np.linalg.norm(M_b), abs(M_t[0])
                used[k] = sum(p / limit for p, limit in zip(parts, self.limits))
        return used


def gradient(r, x, members):
    """The gradient of the displacement that fits these particles best."""
    R = r[members] - r[members].mean(0)
    U = x[members, :3] - x[members, :3].mean(0)
    return np.linalg.solve(R.T @ R, R.T @ U).T


class Specimen:
    """What the rules say of ends, rows and sections."""

    def __init__(self, network, radius, axis, along):
        self.n, self.r, self.R = network, network.r, np.asarray(radius)
        self.axis, self.along = axis, along
        self.third = 3 - axis - along if axis != along else None
        lengths = [np.linalg.norm(self.r[j] - self.r[i]) for i, j in network.pairs]
        self.spacing = np.mean(lengths)
        gaps = [a - self.R[i] - self.R[j] for a, (i, j) in zip(lengths, network.pairs)]
        if min(gaps) > 0.05 * self.spacing:
            self.R = self.R + min(gaps) / 2
        elif max(gaps) < -0.05 * self.spacing:
            self.R = self.R + max(gaps) / 2
        self.low, self.high = (self.r - self.R[:, None]).min(0), (self.r + self.R[:, None]).max(0)

    def side(self, d, upper):
        depth = self.high[d] - self.r[:, d] if upper else self.r[:, d] - self.low[d]
        near = 0.25 * self.spacing
        return np.flatnonzero(depth <= self.R[depth - self.R <= near].max() + near)

    def middle_half(self):
        d = self.axis
        half = 0.25 * (self.high[d] - self.low[d]) + 1e-3 * self.spacing
        return np.flatnonzero(abs(self.r[:, d] - 0.5 * (self.low[d] + self.high[d])) <= half)

    def row(self, side, place):
        x = self.r[side, self.axis]
        return side[abs(x - x[np.argmin(abs(x - place))]) <= 0.3 * self.spacing]


def break_one_by_one(network, held, upper, direction, drop=0.5, tie=5e-4, splits=None):
    """Breaks the bond that uses most of its strength, again and again, until the force has lost `drop` of its peak. `held` is for
    a strain of 1. Returns the force at the first break, that at the peak, the breaks before the peak and all of them, how
    many breaks there were when two bonds were so near to each other that rounding and large strains choose: None if never, and the
    largest force. With `splits` the peak is that after which, for the first time, breaks have taken this part of it."""
    strain, first, peak, broken, before, tied = 0.0, None, 0.0, 0, 0, None
    largest, has_split = 0.0, False
    while True:
        x, f = network.solve(held)
        force = abs(f[upper, direction].sum())
        if splits and broken > before and force * strain <= (1 - splits) * peak:
            has_split = True
        if broken and force * strain <= (1 - drop) * largest:
            return first, peak, before, broken, tied, largest
        used = network.use(x)
        worst, second = np.argsort(used)[:-3:-1]
        if used[worst] <= 0:
            return first, peak, before, broken, tied, largest
        if tied is None and used[second] > (1 - tie) * used[worst]:
            tied = broken
        strain = max(strain, 1 / used[worst])
        first = force * strain if first is None else first
        largest = max(largest, force * strain)
        if force * strain > peak and not has_split:
            peak, before = force * strain, broken
        network.whole[worst] = False
        broken += 1
