# weier with the versions of requirements/run.txt, and its kernels compiled: docker build -t weier .
# docker run --rm -v "$PWD/results:/weier/results" weier --cores 2
FROM python:3.11-slim
WORKDIR /weier
COPY requirements requirements
RUN pip install --no-cache-dir --require-hashes -r requirements/run.txt
COPY . .
RUN pip install --no-cache-dir --no-deps --no-build-isolation -e .
ENV NUMBA_CACHE_DIR=/weier/.kernels
RUN python -m weier compile && chmod -R a+rwX /weier
ENTRYPOINT ["snakemake"]
