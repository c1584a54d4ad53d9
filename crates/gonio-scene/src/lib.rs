//! Scenes: shapes, ray queries, materials, lights, cameras, and readers
