# barrierbench with its device code, built on NVIDIA's image; the card is needed only to run. From the root of the tree:
#   docker build -f containers/cuda.Dockerfile -t barrierbench .
#   docker run --rm --gpus all barrierbench                           # is the card usable: ./bench device --measure
#   docker run --rm --gpus all barrierbench ./bench demo
#   docker run --rm --gpus all -v "$PWD/results/gpu:/barrierbench/results/gpu" barrierbench experiments/gpu_evidence.sh
# CUDA: 12.8 is the first that knows sm_100; any of 12 and 13 will do, for formulas on a card one from 12.8 on (--build-arg CUDA=13.0.0).
ARG CUDA=12.8.1
FROM nvidia/cuda:${CUDA}-devel-ubuntu24.04

ENV DEBIAN_FRONTEND=noninteractive CUDACXX=/usr/local/cuda/bin/nvcc
WORKDIR /barrierbench
# What ./bench setup asks of the system first, so that a change of the sources does not install it again.
COPY bench ./
COPY analysis ./analysis
RUN ./bench setup
COPY . .
# AUTO would build without CUDA where nvcc is broken; here that is an error.
# Builds the program, and nothing else, since the verb needs it.
RUN cmake --preset release -DBB_CUDA=ON && ./bench validity
CMD ["./bench", "device", "--measure"]
