"""How far a picture is from its reference. Pictures are RGBA arrays, transparent where nothing was drawn."""
import flip_evaluator
import numpy as np
from skimage.io import imread
from skimage.metrics import structural_similarity

TILE = 16  # pixels


def read(file):
    picture = imread(file)
    if picture.ndim != 3 or picture.shape[2] != 4:
        raise ValueError(f"{file}: four bytes a pixel were expected")
    return picture


def on_black(picture):
    """As float RGB, 0 to 1."""
    return (picture[:, :, :3] * (picture[:, :, 3:] / 255.0) / 255.0).astype(np.float32)


def flip(reference, picture):
    """Mean FLIP error (Andersson et al. 2020) at 67 pixels a degree: 0: identical, 1: maximum difference."""
    return float(flip_evaluator.evaluate(on_black(reference), on_black(picture), "LDR", applyMagma=False)[1])


def ssim(reference, picture):
    """Structural similarity (Wang et al. 2004), Gaussian window: 1: identical."""
    return float(structural_similarity(on_black(reference), on_black(picture), channel_axis=2, data_range=1.0, gaussian_weights=True, sigma=1.5,
                                       use_sample_covariance=False))


def holes(reference, picture):
    """Share of the pixels that the reference covers and this one does not."""
    covered = reference[:, :, 3] > 0
    return float((covered & (picture[:, :, 3] == 0)).sum() / max(1, covered.sum()))


def spill(reference, picture):
    """Pixels that this one covers and the reference does not, as a share of those that the reference covers: splats larger than what they stand for."""
    covered = reference[:, :, 3] > 0
    return float((~covered & (picture[:, :, 3] > 0)).sum() / max(1, covered.sum()))


def tiles(covered):
    """Number of covered pixels in each tile of 16 x 16; what is left at the right and lower edge is dropped."""
    rows, columns = covered.shape[0] // TILE, covered.shape[1] // TILE
    return covered[:rows * TILE, :columns * TILE].reshape(rows, TILE, columns, TILE).sum(axis=(1, 3))


def blank_tiles(reference, picture, before=None):
    """Tiles of which the reference covers at least a quarter and this one nothing; of those also the number that `before`, the previous picture, covers."""
    blank = (tiles(reference[:, :, 3] > 0) >= TILE * TILE / 4) & (tiles(picture[:, :, 3] > 0) == 0)
    return int(blank.sum()), int((blank & (tiles(before[:, :, 3] > 0) > 0)).sum()) if before is not None else 0


# Against truth, where `asked` are the pixels that a picture can be asked about: all of these take the truth for the others.


def flip_map(truth, picture):
    """FLIP error of each pixel."""
    return flip_evaluator.evaluate(on_black(truth), on_black(picture), "LDR", applyMagma=False)[0].reshape(truth.shape[:2])


def likeness(truth, picture, asked):
    """Means over the pixels asked about: FLIP, SSIM; and PSNR, decibels, at most 99."""
    shown = np.where(asked[:, :, None], picture, truth)
    structure = structural_similarity(on_black(truth), on_black(shown), channel_axis=2, data_range=1.0, gaussian_weights=True, sigma=1.5,
                                      use_sample_covariance=False, full=True)[1]
    square = float(((on_black(truth) - on_black(shown)) ** 2)[asked].mean())
    return {"flip": float(flip_map(truth, shown)[asked].mean()), "ssim": float(structure[asked].mean()), "psnr": float(min(99, -10 * np.log10(max(square, 1e-12))))}


def outlines(labels):
    """Pixels next to another thing or to nothing."""
    edge = np.zeros(labels.shape[:2], bool)
    for axis in (0, 1):
        differs = (np.diff(labels.astype(int), axis=axis) != 0).any(axis=2)
        first, second = [slice(None)] * 2, [slice(None)] * 2
        first[axis], second[axis] = slice(0, -1), slice(1, None)
        edge[tuple(first)] |= differs
        edge[tuple(second)] |= differs
    return edge


def changed(before, after, where):
    """Mean change of a channel, 0 to 255, over some pixels; 0 of none."""
    return float(255 * np.abs(on_black(before) - on_black(after))[where].mean()) if where.any() else 0.0


def changed_share(before, after, more_than=24):
    """Of the pixels that either covers, the share of which a channel changes by more than this (of 255)."""
    covered = (before[:, :, 3] > 0) | (after[:, :, 3] > 0)
    return float((255 * np.abs(on_black(before) - on_black(after)).max(axis=2) > more_than)[covered].mean()) if covered.any() else 0.0
