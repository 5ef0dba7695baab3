"""A made-up study of the fast forms' cost, whose figures follow from a rule that tests can compute."""

FORMULATIONS = ("cotangent", "group", "algebra")
PRODUCT_SECONDS = 1e-9  # times n³
PEAK_GFLOPS = 10.0
REST_SECONDS = 1e-8  # times n²


def row(formulation, stages, n, products, **fields):
    """A cell whose step takes its products' time and REST_SECONDS n² s besides."""
    seconds = products * PRODUCT_SECONDS * n**3 + REST_SECONDS * stages * n**2
    return {"formulation": formulation, "stages": stages, "n": n, "step": 0.1,
            "seconds_per_step": [0.9 * seconds, seconds, 2 * seconds], "sweeps_per_step": products / stages,
            "equivalent_products_per_step": products, "poisson_solves_per_step": products,
            "product_seconds": [PRODUCT_SECONDS * n**3] * 3, "peak_gflops": [PEAK_GFLOPS] * 3, **fields}


def idea_rows(formulation, stages, n):
    """Products from 100 down to 40 by default, where acceleration would take 41 and another start order 80."""
    ideas = {"published": 100, "structure and planar products": 90, "start values": 60}
    if formulation == "group":
        ideas["corrections in single precision"] = 40
    rungs = list(ideas)
    ideas.update({"acceleration": 41 if formulation == "group" else 62,
                  "by default": 40 if formulation == "group" else 60, "start order 4": 80})
    return [row(formulation, stages, n, products * stages, idea=idea, rung=idea in rungs) for idea, products in ideas.items()]


def scaling_document(sizes=(17, 65, 129, 257), idea_sizes=(17,)):
    stages = (1, 2)
    return {"format": "isosyrk scaling 2",
            "context": {"cpu": "some cpu", "blas_kernels": "some kernels", "compiler": "some compiler", "commit": "0" * 40},
            "h_norm_B": 0.4, "kernels": "avx2",
            "points": [row(formulation, s, n, 10.0 * s) for n in sizes for formulation in FORMULATIONS for s in stages],
            "ideas": [each for n in idea_sizes for formulation in FORMULATIONS for s in stages
                      for each in idea_rows(formulation, s, n)]}
