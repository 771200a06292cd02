# Measurements of the methods, each with a figure: snakemake --cores 2 tradeoff, convergence or extremes
rule tradeoff:
    input:
        multiext("results/tradeoff/work_precision", ".pdf", ".svg", ".png"),


rule convergence:
    input:
        multiext("results/convergence/convergence", ".pdf", ".svg", ".png"),


rule extremes:
    input:
        multiext("results/extremes/extremes", ".pdf", ".svg", ".png"),


# It takes all cores, since other jobs would disturb the measured times.
rule measure_tradeoff:
    input:
        kernels=ancient(kernels_of(METHODS)),
        scene=configured("accuracy/tradeoff.yaml"),
    output:
        data="results/tradeoff/tradeoff.nc",
        page="results/tradeoff/tradeoff.md",
    log:
        "results/logs/tradeoff/measure.log",
    conda:
        environment
    threads: cores()
    params:
        depends_on=digest_of_study("tradeoff"),
    shell:
        "OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 python -m weier.accuracy tradeoff --scene {input.scene:q} --output {output.page:q} 2>&1 | tee -i {log:q}"


rule measure_convergence:
    input:
        kernels=ancient(kernels_of(METHODS)),
        scene=configured("accuracy/infinite.yaml"),
    output:
        data="results/convergence/convergence.nc",
        page="results/convergence/convergence.md",
    log:
        "results/logs/convergence/measure.log",
    conda:
        environment
    params:
        depends_on=digest_of_study("convergence"),
    shell:
        "python -m weier.accuracy convergence --scene {input.scene:q} --output {output.page:q} 2>&1 | tee -i {log:q}"


rule measure_extremes:
    input:
        kernels=ancient(kernels_of(METHODS)),
    output:
        data="results/extremes/extremes.nc",
        page="results/extremes/extremes.md",
    log:
        "results/logs/extremes/measure.log",
    conda:
        environment
    params:
        depends_on=digest_of_study("extremes"),
    shell:
        "python -m weier.accuracy extremes --output {output.page:q} 2>&1 | tee -i {log:q}"


rule draw:
    input:
        "results/{study}/{study}.nc",
    output:
        pdf="results/{study}/{figure}.pdf",
        svg="results/{study}/{figure}.svg",
        png=report(
            "results/{study}/{figure}.png",
            category="methods",
            subcategory="{study}",
            labels=labels_of_measurement,
        ),
    log:
        "results/logs/{study}/{figure}.log",
    wildcard_constraints:
        study="tradeoff|convergence|extremes",
    conda:
        environment
    params:
        depends_on=lambda wildcards: digest_of_code(
            (f"weier.figures.{wildcards.figure}", "draw"), ("weier.figures", "draw")
        ),
    shell:
        "python -m weier draw {wildcards.figure:q} {output.png:q} {input:q} 2>&1 | tee -i {log:q}"
