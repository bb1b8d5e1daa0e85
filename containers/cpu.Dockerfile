# barrierbench for nodes that have none of its packages. From the root of the tree:
#   docker build -f containers/cpu.Dockerfile -t barrierbench .
#   docker run --rm -v "$PWD/results:/barrierbench/results" barrierbench ./bench sweep configs/sweeps/demo_strip.json --out results/runs/strip
# The processor that it is built for: x86-64-v3 by default (--build-arg ARCH=x86-64 for older ones).
FROM debian:12-slim
ARG ARCH=x86-64-v3

ENV DEBIAN_FRONTEND=noninteractive
WORKDIR /barrierbench
# What ./bench setup asks of the system first, so that a change of the sources does not install it again.
COPY bench ./
COPY analysis ./analysis
RUN apt-get update -qq && apt-get install -y -qq --no-install-recommends parallel && ./bench setup
COPY . .
# Builds the program, and nothing else, since the verb needs it.
RUN cmake --preset release -DBB_CUDA=OFF -DBB_ARCH=${ARCH} && ./bench validity
CMD ["./bench", "validity"]
