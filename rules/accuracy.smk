# Speed against accuracy: measured on its own, since other jobs beside it would disturb the seconds.
rule tradeoff:
    input:
        "results/tradeoff/tradeoff.nc",
        expand("results/tradeoff/work_precision.{e}", e=["pdf", "svg", "png"]),


rule measure_tradeoff:
    input:
        source=sources("weier.accuracy.tradeoff"),
        kernels="results/.kernels",
        scene="config/scenes/tradeoff.yaml",
    output:
        data="results/tradeoff/tradeoff.nc",
        table="results/tradeoff/tradeoff.md",
    log:
        "results/logs/tradeoff/measure.log",
    conda:
        "environment.yaml"
    threads: 999  # all there are: snakemake takes no more than --cores, and workflow.cores is unknown to --unlock
    shell:
        "OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 python -m weier tradeoff {input.scene} {output} 2>&1 | tee {log}"


rule draw_tradeoff:
    input:
        source=sources("weier.figures.work_precision"),
        data="results/tradeoff/tradeoff.nc",
    output:
        multiext("results/tradeoff/work_precision", pdf=".pdf", svg=".svg", png=".png"),
    log:
        "results/logs/tradeoff/draw.log",
    conda:
        "environment.yaml"
    shell:
        "python -m weier draw work_precision {output.png} {input.data} 2>&1 | tee {log}"


rule endless:
    input:
        "results/endless/endless.nc",
        expand("results/endless/endless.{e}", e=["pdf", "svg", "png"]),


rule solve_endless:
    input:
        source=sources("weier.methods.hybrid"),
        kernels="results/.kernels",
        scene="config/scenes/endless.yaml",
    output:
        "results/endless/endless.nc",
    log:
        "results/logs/endless/solve.log",
    conda:
        "environment.yaml"
    shell:
        "python -m weier endless {input.scene} {output} 2>&1 | tee {log}"


rule draw_endless:
    input:
        source=sources("weier.figures.endless"),
        data="results/endless/endless.nc",
    output:
        multiext("results/endless/endless", pdf=".pdf", svg=".svg", png=".png"),
    log:
        "results/logs/endless/draw.log",
    conda:
        "environment.yaml"
    shell:
        "python -m weier draw endless {output.png} {input.data} 2>&1 | tee {log}"


# What the scenes that would run plan to do: snakemake --cores 1 plan --config scenes=planned
rule plan:
    input:
        source=sources("weier.pipeline.plan"),
        scenes=expand(
            "config/scenes/{s}.yaml",
            s=[name.strip() for name in str(config["scenes"]).split(",")],
        ),
    log:
        "results/logs/plan.log",
    conda:
        "environment.yaml"
    shell:
        "for scene in {input.scenes}; do python -m weier plan $scene; done 2>&1 | tee {log}"
