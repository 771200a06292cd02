# Every method where digits are lost: a table, a figure and the data, in some minutes.
rule extremes:
    input:
        "results/extremes/extremes.nc",
        "results/extremes/extremes.md",
        expand("results/extremes/extremes.{e}", e=["pdf", "svg", "png"]),


rule measure_extremes:
    input:
        source=sources("weier.accuracy.extremes"),
        kernels="results/.kernels",
    output:
        data="results/extremes/extremes.nc",
        table="results/extremes/extremes.md",
    log:
        "results/logs/extremes/measure.log",
    conda:
        "environment.yaml"
    shell:
        "python -m weier extremes {output} 2>&1 | tee {log}"


rule draw_extremes:
    input:
        source=sources("weier.figures.extremes"),
        data="results/extremes/extremes.nc",
    output:
        multiext("results/extremes/extremes", pdf=".pdf", svg=".svg", png=".png"),
    log:
        "results/logs/extremes/draw.log",
    conda:
        "environment.yaml"
    shell:
        "python -m weier draw extremes {output.png} {input.data} 2>&1 | tee {log}"
