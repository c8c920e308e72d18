#pragma once
/// The one macro of the project: marks a function that must also compile for a GPU.
/// A host program that embeds the physics may define VBOND_HD itself before including any header.
#if !defined(VBOND_HD)
#if defined(__CUDACC__) || defined(__HIPCC__)
#define VBOND_HD __host__ __device__
#else
#define VBOND_HD
#endif
#endif
