//! What the machine can do: the two limits the hot loop is held against.

use std::hint::black_box;
use std::time::Instant;

/// Bytes a second of the triad a ← b + s c over three columns of so many numbers, on so many threads: two are read, one is read
/// and written (32 bytes a place, the line of `a` that is fetched before it is written included).
pub fn triad(length: usize, threads: usize) -> f64 {
    let part = length / threads;
    let seconds: Vec<f64> = std::thread::scope(|scope| {
        let worker = || {
            let (mut a, b, c) = (vec![0.0f64; part], vec![1.0f64; part], vec![2.0f64; part]);
            let turns = (1 << 27) / length.max(1) + 2;
            let mut least = f64::INFINITY;
            for _ in 0..5 {
                let begin = Instant::now();
                for _ in 0..turns {
                    for ((a, b), c) in a.iter_mut().zip(&b).zip(&c) {
                        *a = b + 3.0 * c;
                    }
                    black_box(&mut a);
                }
                least = least.min(begin.elapsed().as_secs_f64() / turns as f64);
            }
            least
        };
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(worker)).collect();
        workers.into_iter().map(|worker| worker.join().expect("no panic")).collect()
    });
    let slowest = seconds.into_iter().fold(0.0, f64::max);
    32.0 * (part * threads) as f64 / slowest
}

/// Seconds of the square roots and divisions of one pair, `roots` and one, in vectors as wide as the machine has and with
/// nothing else to wait for: no loop that needs them can be faster.
pub fn roots_and_division(roots: usize) -> f64 {
    let mut column = [1.5f64; 512];
    let turns = 20_000;
    let mut least = f64::INFINITY;
    for _ in 0..5 {
        let begin = Instant::now();
        for _ in 0..turns {
            pulp::Arch::new().dispatch(
                #[inline(always)]
                || {
                    for x in &mut column {
                        let divided = 1.0 / *x;
                        let first = (*x + 1.0).sqrt();
                        let second = if roots > 1 { (*x + 2.0).sqrt() } else { 0.0 };
                        // Stays between 1 and 5: no number the unit is slow on.
                        *x = 1.0 + divided + 0.5 * first + 0.25 * second;
                    }
                },
            );
            black_box(&mut column);
        }
        least = least.min(begin.elapsed().as_secs_f64() / (turns * column.len()) as f64);
    }
    least
}
