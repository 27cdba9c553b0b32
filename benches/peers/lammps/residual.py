"""jamscope's residual of soft disks, from their positions."""

import numpy as np

from peer import force

# Pairs the residual looks at: as far apart as this beyond contact at the start, anew after half of it [length].
MARGIN = 0.3


class Residual:
    """Largest net elastic force on the mobile backbone over the backbone's mean contact force; `sides`: of a periodic box."""

    def __init__(self, radius, held, sides=None, law="hertz"):
        self.radius, self.held, self.sides, self.law = radius, held, sides, law
        self.listed = None

    def nearest(self, apart):
        """The shortest of the vectors between the images of two disks."""
        return apart if self.sides is None else apart - self.sides * np.round(apart / self.sides)

    def pairs_near(self, position):
        """All pairs whose gap is below MARGIN, not both held, by a grid of cells."""
        size = 2 * self.radius.max() + MARGIN
        place, owner = position, np.arange(len(position))
        if self.sides is not None:
            # With images of the disks that touch the box from outside.
            place = np.mod(position, self.sides)
            images = [place + np.array([x, y]) * self.sides for x in (-1, 0, 1) for y in (-1, 0, 1) if (x, y) != (0, 0)]
            images, of_image = np.concatenate(images), np.tile(owner, 8)
            near = ((images > -size) & (images < self.sides + size)).all(axis=1)
            place, owner = np.concatenate([place, images[near]]), np.concatenate([owner, of_image[near]])
        cell = np.floor((place - place.min(axis=0)) / size).astype(int) + 1
        width = cell[:, 1].max() + 2
        key = cell[:, 0] * width + cell[:, 1]
        order = np.argsort(key, kind="stable")
        first, second = [], []
        for across, along in ((0, 0), (0, 1), (1, -1), (1, 0), (1, 1)):
            other = key + across * width + along
            begin = np.searchsorted(key[order], other, "left")
            count = np.searchsorted(key[order], other, "right") - begin
            i = np.repeat(np.arange(len(key)), count)
            j = order[np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count) + np.repeat(begin, count)]
            keep = i < j if (across, along) == (0, 0) else slice(None)
            first.append(i[keep])
            second.append(j[keep])
        i, j = owner[np.concatenate(first)], owner[np.concatenate(second)]
        if self.sides is not None:
            i, j = np.unique(np.sort(np.stack([i, j]), axis=0), axis=1)
        gap = np.hypot(*self.nearest(position[i] - position[j]).T) - self.radius[i] - self.radius[j]
        keep = (gap < MARGIN) & ~(self.held[i] & self.held[j])
        self.first, self.second, self.listed = i[keep], j[keep], position.copy()

    def of(self, position, net=None):
        """`net`: forces on the disks where they are not those of the law itself, as of a table."""
        if self.listed is None or np.abs(position - self.listed).max() > 0.3 * MARGIN:
            self.pairs_near(position)
        i, j = self.first, self.second
        apart = self.nearest(position[i] - position[j])
        distance = np.hypot(*apart.T)
        touch = distance < self.radius[i] + self.radius[j]
        i, j, apart, distance = i[touch], j[touch], apart[touch], distance[touch]
        size = force(self.law, self.radius[i], self.radius[j], distance)
        count = len(position)
        if net is None:
            pair = (size / distance)[:, None] * apart
            net = np.stack([np.bincount(i, pair[:, d], count) - np.bincount(j, pair[:, d], count) for d in range(2)], axis=1)
        self.mean_force, self.virial = 0.0, float((size * distance).sum())
        backbone = np.ones(count, bool)
        while True:
            both = backbone[i] & backbone[j]
            contacts = np.bincount(i[both], minlength=count) + np.bincount(j[both], minlength=count)
            loose = backbone & ~self.held & (contacts < 3)
            if not loose.any():
                break
            backbone &= ~loose
        mobile = backbone & ~self.held
        if not mobile.any():
            return float("inf")
        self.mean_force = float(size[both].mean())
        return float(np.hypot(*net[mobile].T).max() / self.mean_force)
