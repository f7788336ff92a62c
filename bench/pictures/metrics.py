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
    """Mean FLIP error (Andersson et al. 2020) at 67 pixels a degree: 0 alike, 1 as unlike as can be."""
    return float(flip_evaluator.evaluate(on_black(reference), on_black(picture), "LDR", applyMagma=False)[1])


def ssim(reference, picture):
    """Structural similarity (Wang et al. 2004), Gaussian window: 1 alike."""
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
