"""Progress of what takes long, as the library calls it."""


def callback(progress):
    """What the library calls: None, or a function of (fraction, stage).

    `progress`: None; True, a bar of tqdm where that is installed; or a function of (fraction from 0 to 1, text), which
    cancels by returning False.
    """
    if progress is None or progress is False:
        return None
    if progress is not True:
        return progress
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return None
    bar = tqdm(total=100, bar_format="{desc}: {percentage:3.0f}%|{bar}| {elapsed}<{remaining}")

    def show(fraction, stage):
        bar.set_description_str(stage, refresh=False)
        bar.update(100 * fraction - bar.n)
        if fraction >= 1:
            bar.close()

    return show
