# A job for each method, so that methods are compiled in parallel, before the batches that need them.
rule compile:
    output:
        touch(kernels_file("{method}")),
    log:
        "results/logs/compile/{method}.log",
    priority: 3  # first, since it takes longest: what needs no kernels is solved beside it
    conda:
        environment
    message:
        "compile {wildcards.method}"
    shell:
        "python -m weier compile {wildcards.method:q} 2>&1 | tee -i {log:q}"
