// Kernels that break a rule, as PTX.
#include "core/exec/cuda/device_block.cuh"
#include "tests/ptx/faulty_kernels.hpp"
#include "tests/ptx/instantiate.cuh"

EACH(bb::faulty::OneTooFar)
EACH(bb::faulty::ReadsBefore)
EACH(bb::faulty::Misaligned)
EACH(bb::faulty::ReadsNeighbour)
EACH(bb::faulty::AllWriteOne)
BLOCKS(bb::faulty::ReadsNextBlock)
BLOCKS(bb::faulty::ReadsACounter)
BLOCKS(bb::faulty::WritesWhatAnotherBlockRead)
BLOCKS(bb::faulty::LastBlockReads)
EACH(bb::faulty::Endless)
BLOCKS(bb::faulty::MissingBarrier)
BLOCKS(bb::faulty::WritesTogether)
BLOCKS(bb::faulty::BarrierOfSome)
BLOCKS(bb::faulty::ShuffleOfSome)
