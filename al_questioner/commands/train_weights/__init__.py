"""The `train_weights` executable: learns the weights from an expert's bags."""
