"""`wirerope compile`: all kernels compiled beforehand."""


def compile_kernels() -> int:
    """Compile all kernels for this computer, so that no later command waits for one.

    Kernels that the package brought along, or that were compiled before, are only looked at. Without any it takes minutes.
    """
    from wirerope_mj.foundation.kernel_files import LOADED, cache_folder, where_kept
    from wirerope_mj.runs.kernels import use_all_kernels

    use_all_kernels()
    print(f"All kernels are compiled: {len(LOADED)} were at hand; {where_kept(cache_folder())}.")
    return 0
