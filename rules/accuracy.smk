# What is measured of the methods, and the figure of each: snakemake --cores 2 tradeoff, convergence or extremes
for study, figure in {
    "tradeoff": "work_precision",
    "convergence": "convergence",
    "extremes": "extremes",
}.items():

    rule:
        name:
            study
        input:
            data=f"results/{study}/{study}.nc",
        output:
            pdf=f"results/{study}/{figure}.pdf",
            svg=f"results/{study}/{figure}.svg",
            png=report(
                f"results/{study}/{figure}.png",
                category="methods",
                subcategory=study,
                labels={"figure": figure, "caption": kinds()[figure].caption},
            ),
        log:
            f"results/logs/{study}/draw.log",
        conda:
            "environment.yaml"
        params:
            figure=figure,
            program=digest_of_program(*PICTURES),
        shell:
            "python -m weier draw {params.figure:q} {output.png:q} {input.data:q} 2>&1 | tee -i {log:q}"


# On its own, since other jobs beside it would disturb the seconds.
rule measure_tradeoff:
    input:
        kernels=kernels(),
        scene=in_checkout("config/accuracy/tradeoff.yaml"),
    output:
        data="results/tradeoff/tradeoff.nc",
        table="results/tradeoff/tradeoff.md",
    log:
        "results/logs/tradeoff/measure.log",
    conda:
        "environment.yaml"
    threads: 999  # all there are: snakemake takes no more than --cores, and workflow.cores is unknown to --unlock
    params:
        program=digest_of_program(*MEASURED),
    shell:
        "OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 python -m weier tradeoff {input.scene:q} {output:q} 2>&1 | tee -i {log:q}"


rule measure_convergence:
    input:
        kernels=kernels(),
        scene=in_checkout("config/accuracy/infinite.yaml"),
    output:
        "results/convergence/convergence.nc",
    log:
        "results/logs/convergence/measure.log",
    conda:
        "environment.yaml"
    params:
        program=digest_of_program(*MEASURED),
    shell:
        "python -m weier convergence {input.scene:q} {output:q} 2>&1 | tee -i {log:q}"


rule measure_extremes:
    input:
        kernels=kernels(),
    output:
        data="results/extremes/extremes.nc",
        summary="results/extremes/extremes.md",
    log:
        "results/logs/extremes/measure.log",
    conda:
        "environment.yaml"
    params:
        program=digest_of_program(*MEASURED),
    shell:
        "python -m weier extremes {output:q} 2>&1 | tee -i {log:q}"


# What the scenes that would run plan to do: snakemake --cores 1 plan --config scenes=planned
rule plan:
    input:
        scenes=[scene_file(name) for name in scene_names()],
    log:
        "results/logs/plan.log",
    conda:
        "environment.yaml"
    shell:
        'for scene in {input.scenes:q}; do python -m weier plan "$scene"; done 2>&1 | tee -i {log:q}'
