# One HTML page a scene, to look through: snakemake --cores 2 pages --config scenes=paper
rule pages:
    input:
        expand("results/{s}/page.html", s=scene_names()),


for name in scene_names():

    rule:
        name:
            f"page_{name}"
        input:
            list(getattr(rules, f"figures_{name}").output),  # of a named input, Snakemake forgets the rule
            contact=f"results/{name}/contact.nc",
        output:
            f"results/{name}/page.html",
        log:
            f"results/logs/{name}/page.log",
        conda:
            "environment.yaml"
        params:
            scene=scene_file(name),
            folder=lambda w, name=name: f"results/{name}",
            figures=lambda w, name=name: repr(scene(name).figures),
            program=digest_of_program(*PICTURES),
        message:
            f"{name}: write the page"
        shell:
            "python -m weier page {params.scene:q} {params.folder}/batches {input.contact:q} {output:q} {params.folder}/figures"
            " 2>&1 | tee -i {log:q}"
